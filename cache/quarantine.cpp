// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/quarantine.h"

#include <fstream>
#include <mutex>

#include <spdlog/spdlog.h>

namespace salbench {

namespace fs = std::filesystem;

void Quarantine::list() {
  std::set<DamagedName> found = list_damaged(folder_);
  const std::unique_lock lock(mutex_);
  artefacts_ = std::move(found);
}

bool Quarantine::has(const std::string& segment, const Digest& key) const {
  const std::shared_lock lock(mutex_);
  return !artefacts_.empty() && artefacts_.contains({segment, key});
}

// A file that is gone (another process collects, or quarantines the same file) needs no warning.
void Quarantine::move(const fs::path& file, std::string_view why) const {
  std::error_code error;
  if (!may_write_) {
    spdlog::warn("{}: {}; a run will compute what was in it again", file.string(), why);
    return;
  }
  fs::create_directories(folder_ / kDamagedFolder, error);
  fs::rename(file, folder_ / kDamagedFolder / file.filename(), error);
  if (!error)
    spdlog::warn("{}: {}; moved to {}/, and what was in it is computed again", file.string(), why,
                 (folder_ / kDamagedFolder).string());
  else if (error != std::errc::no_such_file_or_directory)
    spdlog::warn("{}: {}; what was in it is computed again (it cannot be moved aside: {})", file.string(),
                 why, error.message());
}

void Quarantine::set_aside(const fs::path& segment, const Digest& key) {
  if (!may_write_) return;
  const DamagedName name{segment.filename().string(), key};
  std::error_code error;
  fs::create_directories(folder_ / kDamagedFolder, error);
  const std::ofstream created(folder_ / kDamagedFolder / name.text());
  const std::unique_lock lock(mutex_);
  artefacts_.insert(name);
}

void Quarantine::forget(const std::string& segment) {
  const std::unique_lock lock(mutex_);
  std::error_code error;
  std::erase_if(artefacts_, [&](const DamagedName& name) {
    return name.segment == segment && (fs::remove(folder_ / kDamagedFolder / name.text(), error), true);
  });
}

}  // namespace salbench
