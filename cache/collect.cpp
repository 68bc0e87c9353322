// SPDX-License-Identifier: GPL-3.0-or-later
// Empty folders stay: another process may be about to rename an artefact into one.
#include "cache/collect.h"

#include <fmt/format.h>

#include "cache/layout.h"
#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

// A file that disappeared in the meantime is ignored.
void remove_file(const fs::path& file, bool dry_run, Amount& amount) {
  const auto size = size_of_file(file);
  if (!size) return;
  std::error_code error;
  if (!dry_run) fs::remove(file, error);
  if (error)
    throw StorageError(fmt::format("{}: cannot be removed: {}", file.string(), system_reason(error.value())));
  amount.add(*size);
}

}  // namespace

void KeepSet::add(std::string_view stage, const Digest& key) { stages_[std::string(stage)].keys.insert(key); }

void KeepSet::add_every_key(std::string_view stage, std::string_view item) {
  stages_[std::string(stage)].items.insert(item_label(item));
}

bool KeepSet::covers(std::string_view stage, const ArtefactName& name) const {
  const auto found = stages_.find(stage);
  return found != stages_.end() &&
         (found->second.keys.contains(name.key) || found->second.items.contains(name.item));
}

Collected collect_garbage(const fs::path& folder, const KeepSet& needed, bool dry_run, Progress& progress) {
  require_cache(folder);
  Collected result;
  const CacheListing listing = list_cache(folder);
  progress.begin("collecting", listing.artefacts);
  for (const ShardFolder& shard : listing.shards) {
    if (result.stages.empty() || result.stages.back().stage != shard.stage)
      result.stages.push_back({shard.stage, {}, {}});
    Collected::OfStage& stage = result.stages.back();
    for (const ArtefactFile& file : list_shard(folder, shard)) {
      if (needed.covers(file.stage, file.name))
        stage.kept.add(file.name.size);
      else
        remove_file(file.path, dry_run, stage.removed);
      progress.item_done();
    }
  }
  progress.end();
  for (const FolderEntry& entry : list_folder(folder / kDamagedFolder))
    if (!entry.is_folder && parse_artefact_name(entry.path.filename().native()))
      remove_file(entry.path, dry_run, result.damaged);
  visit_abandoned(folder / kScratchFolder,
                  [&](const fs::path& file) { remove_file(file, dry_run, result.unfinished); });
  return result;
}

}  // namespace salbench
