// Folders stay, also empty ones: another process may be about to rename an artefact into one.
#include "cache/collect.h"

#include <fmt/format.h>

#include "cache/files.h"
#include "cache/layout.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

// What vanished meanwhile counts as nothing.
void remove_file(const fs::path& file, bool dry_run, Amount& amount) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  if (error == std::errc::no_such_file_or_directory) return;
  if (!dry_run && !error) fs::remove(file, error);
  if (error) throw StorageError(fmt::format("{}: cannot be removed: {}", file.string(), error.message()));
  amount.add(size);
}

std::vector<fs::path> set_aside_artefacts(const fs::path& damaged) {
  std::vector<fs::path> files;
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator(damaged, missing))
    if (parse_artefact_name(entry.path().filename().string()) && entry.is_regular_file())
      files.push_back(entry.path());
  return files;
}

}  // namespace

void Needed::add(std::string_view stage, const Digest& key) { stages_[std::string(stage)].keys.insert(key); }

void Needed::add_every_key(std::string_view stage, std::string_view item) {
  stages_[std::string(stage)].items.insert(item_label(item));
}

bool Needed::covers(std::string_view stage, const ArtefactName& name) const {
  const auto found = stages_.find(stage);
  return found != stages_.end() &&
         (found->second.keys.contains(name.key) || found->second.items.contains(name.item));
}

Collected collect_garbage(const fs::path& folder, const Needed& needed, bool dry_run) {
  require_cache(folder);
  Collected result;
  for (const ArtefactFile& file : list_cache(folder).artefacts) {
    if (result.stages.empty() || result.stages.back().stage != file.stage)
      result.stages.push_back({file.stage, {}, {}});
    Collected::OfStage& stage = result.stages.back();
    if (needed.covers(file.stage, file.name))
      stage.kept.add(file.name.size);
    else
      remove_file(file.path, dry_run, stage.removed);
  }
  for (const fs::path& file : set_aside_artefacts(folder / kDamagedFolder))
    remove_file(file, dry_run, result.damaged);
  for (const fs::path& file : orphans(folder / kScratchFolder)) remove_file(file, dry_run, result.unfinished);
  return result;
}

}  // namespace salbench
