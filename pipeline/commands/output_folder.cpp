// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/output_folder.h"

#include <cerrno>
#include <chrono>
#include <mutex>
#include <set>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/file.h>
#include <sys/stat.h>

#include "io/file.h"
#include "pipeline/commands/conclude.h"
#include "pipeline/config/section.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kHead = 1U << 16U;  // of run.yaml: its first key stands behind remarks of the data set
constexpr std::chrono::milliseconds kPoll{100};

// Folders that runs of this process write to.
class Written {
 public:
  bool insert(const std::pair<dev_t, ino_t>& folder) {
    const std::lock_guard lock(mutex_);
    return folders_.insert(folder).second;
  }
  void erase(const std::pair<dev_t, ino_t>& folder) {
    const std::lock_guard lock(mutex_);
    folders_.erase(folder);
  }

 private:
  std::mutex mutex_;
  std::set<std::pair<dev_t, ino_t>> folders_;
};

Written& written() {
  static Written folders;
  return folders;
}

std::string advice() { return "choose another with " + as_option("out"); }

// False: stopped. A file system without locks has none to wait for.
bool wait_for(const fs::path& path, int folder, const std::atomic<bool>& stop) {
  for (bool first = true; ::flock(folder, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK; first = false) {
    if (stop) return false;
    if (first) spdlog::warn("{}: another call writes to this folder; waiting for its end", path.string());
    std::this_thread::sleep_for(kPoll);
  }
  return true;
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& folder, const std::atomic<bool>& stop)
    : path_(folder), folder_(-1) {
  make_folder(folder, advice());
  folder_ = Descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (struct stat status{}; folder_.get() >= 0 && ::fstat(folder_.get(), &status) == 0)
    identity_ = {status.st_dev, status.st_ino};
  if (!written().insert(identity_))
    throw ConfigError(
        fmt::format("{}: another run of this process writes to this folder; {}", folder.string(), advice()));
  try {
    is_held_ = wait_for(folder, folder_.get(), stop);
    if (is_held_) require_own();
  } catch (...) {
    written().erase(identity_);
    throw;
  }
}

OutputFolder::~OutputFolder() {
  if (folder_.get() >= 0) ::flock(folder_.get(), LOCK_UN);  // a process that was forked has a copy
  written().erase(identity_);
}

void OutputFolder::require_own() const {
  if (size_of_file(path_ / kRecord)) {
    if (!is_record_text(read_head(path_ / kRecord, kHead)))
      throw ConfigError(fmt::format("{}: is no record of a run, and one would take its place; {}",
                                    (path_ / kRecord).string(), advice()));
    return;
  }
  for (const std::string& name : files_of_scores())
    if (std::error_code none; fs::exists(path_ / name, none))
      throw ConfigError(fmt::format("{}: has {}, and no {}, so it is of no run, which would replace it; {}",
                                    path_.string(), name, kRecord, advice()));
}

void OutputFolder::begin(const std::string& record) const {
  visit_abandoned(path_, [](const fs::path& file) { fs::remove(file); });
  write_file(path_ / kRecord, record);
}

}  // namespace salbench
