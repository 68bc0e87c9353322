// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/folder_store.h"

#include <atomic>
#include <map>
#include <mutex>
#include <shared_mutex>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "cache/artefact_name.h"
#include "cache/layout.h"
#include "cache/verify.h"
#include "io/file.h"
#include "io/hdf5_file.h"
#include "stages/core/errors.h"
#include "stages/core/parallel.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

struct StageEntries {
  std::unordered_map<Digest, ArtefactName> by_key;
  std::unordered_set<std::string> items;
};

constexpr std::size_t kShardGrain = 16;  // shards that are listed by one thread at a time

Attributes describe(const Recipe& recipe, std::string_view kind, const Digest& key, const Digest& content,
                    const ArtefactNote& note) {
  Attributes attributes = {{"program", fmt::format("salbench {}", SALBENCH_VERSION)},
                           {"item", note.item},
                           {"kind", std::string(kind)},
                           {"stage", recipe.stage},
                           {"stage_version", std::int64_t{recipe.stage_version}},
                           {"options", recipe.options},
                           {"seed", recipe.seed},
                           {"inputs", inputs_text(recipe)},
                           {"key", key.hex()},
                           {"content", content.hex()},
                           {"seconds", note.seconds}};
  attributes.insert(attributes.end(), note.attributes.begin(), note.attributes.end());
  return attributes;
}

}  // namespace

struct FolderStore::Impl {
  fs::path folder;
  Access access;
  mutable std::shared_mutex mutex;  // of stages
  std::map<std::string, StageEntries, std::less<>> stages;
  std::once_flag prepared;
  std::atomic<bool> is_synced = true;  // nothing was saved since the last sync

  fs::path path(std::string_view stage, const ArtefactName& name) const {
    return folder / shard_of(stage, name.key) / name.text();
  }

  const ArtefactName* entry(std::string_view stage, const Digest& key) const {
    const auto entries = stages.find(stage);
    if (entries == stages.end()) return nullptr;
    const auto found = entries->second.by_key.find(key);
    return found == entries->second.by_key.end() ? nullptr : &found->second;
  }

  static void insert(ArtefactName name, StageEntries& entries) {
    entries.items.insert(name.item);
    const auto [known, fresh] = entries.by_key.try_emplace(name.key);
    // Two contents under one key: some stage is not deterministic. Every machine takes the smaller digest.
    if (fresh || name.content < known->second.content) known->second = std::move(name);
  }

  // A file whose size is not the one in its name was truncated by others: not listed, so a miss. Moved aside,
  // it is not reported again at each listing.
  bool is_complete(const fs::path& shard, std::string_view file, const ArtefactName& name,
                   std::uintmax_t bytes) const {
    if (bytes == name.size) return true;
    quarantine(shard / file, fmt::format("truncated: {} of {} bytes", bytes, name.size));
    return false;
  }

  std::vector<ArtefactName> complete_artefacts(const fs::path& shard) const {
    std::vector<ArtefactName> complete;
    visit_files(shard, [&](std::string_view file, std::uintmax_t bytes) {
      if (auto name = parse_artefact_name(file); name && is_complete(shard, file, *name, bytes))
        complete.push_back(std::move(*name));
    });
    return complete;
  }

  // Most of the time of a run with nothing to do: several stages at a time, and several shards of each.
  void list_all() {
    std::vector<std::pair<const std::string, StageEntries>*> listed;
    for (const std::string& stage : list_stages(folder)) listed.push_back(&*stages.try_emplace(stage).first);
    parallel_ranges(listed.size(), 1, [&](std::size_t i, std::size_t) {
      auto& [stage, entries] = *listed[i];
      const std::vector<FolderEntry> shards = list_folder(folder / stage);
      std::vector<std::vector<ArtefactName>> found(shards.size());
      parallel_ranges(shards.size(), kShardGrain, [&](std::size_t first, std::size_t last) {
        for (std::size_t s = first; s < last; ++s)
          if (shards[s].is_folder) found[s] = complete_artefacts(shards[s].path);
      });
      for (std::vector<ArtefactName>& names : found)
        for (ArtefactName& name : names) insert(std::move(name), entries);
    });
    std::erase_if(stages, [](const auto& stage) { return stage.second.by_key.empty(); });
  }

  // A file that is gone (another process collects, or quarantines the same file) needs no warning.
  void quarantine(const fs::path& file, std::string_view why) const {
    std::error_code error;
    if (access == Access::read_only) {
      spdlog::warn("{}: {}; a run will compute it again", file.string(), why);
      return;
    }
    fs::create_directories(folder / kDamagedFolder, error);
    fs::rename(file, folder / kDamagedFolder / file.filename(), error);
    if (!error)
      spdlog::warn("{}: {}; moved to {}/ and computed again", file.string(), why,
                   (folder / kDamagedFolder).string());
    else if (error != std::errc::no_such_file_or_directory)
      spdlog::warn("{}: {}; computed again (it cannot be moved aside: {})", file.string(), why,
                   error.message());
  }

  // Calls `parse`, which returns a result and a fault, on an artefact's bytes; a fault quarantines the file.
  // A missing file is a miss; one that the system does not let us read is an error, not damage.
  template <class Result, class Parse>
  std::optional<Result> read(std::string_view stage, const Digest& key, const Parse& parse) {
    std::optional<ArtefactName> name;
    {
      const std::shared_lock lock(mutex);
      if (const ArtefactName* known = entry(stage, key)) name = *known;
    }
    if (!name) return {};
    const fs::path file = path(stage, *name);
    if (auto bytes = read_bytes(file)) {
      auto [result, fault] = parse(std::move(*bytes), *name);
      if (fault.empty()) return std::move(result);
      quarantine(file, fault);
    }
    forget(stage, key);
    return {};
  }

  void forget(std::string_view stage, const Digest& key) {
    const std::unique_lock lock(mutex);
    stages.find(stage)->second.by_key.erase(key);
  }
};

FolderStore::FolderStore(fs::path folder, Access access) : impl_(std::make_unique<Impl>()) {
  impl_->folder = std::move(folder);
  impl_->access = access;
  std::error_code error;
  if (fs::exists(impl_->folder, error) && !fs::is_directory(impl_->folder, error))
    throw StorageError(
        fmt::format("{}: is not a folder; choose another with --cache", impl_->folder.string()));
  check_format(impl_->folder);
  if (access == Access::read_write)
    visit_abandoned(impl_->folder / kScratchFolder, [&](const fs::path& file) { fs::remove(file, error); });
  impl_->list_all();
}

FolderStore::~FolderStore() = default;

std::optional<Digest> FolderStore::find(std::string_view stage, const Digest& key) const {
  const std::shared_lock lock(impl_->mutex);
  const ArtefactName* entry = impl_->entry(stage, key);
  return entry == nullptr ? std::nullopt : std::optional(entry->content);
}

bool FolderStore::has_item(std::string_view stage, std::string_view item) const {
  const std::shared_lock lock(impl_->mutex);
  const auto entries = impl_->stages.find(stage);
  return entries != impl_->stages.end() && entries->second.items.contains(item_label(item));
}

// The names are read without the lock: on a network file system that takes its time.
std::optional<Digest> FolderStore::refresh_and_find(std::string_view stage, const Digest& key) {
  if (const auto content = find(stage, key)) return content;
  for (const ArtefactName& name : find_artefacts(impl_->folder, stage, key)) {
    const fs::path file = impl_->path(stage, name);
    const auto bytes = size_of_file(file);
    if (!bytes || !impl_->is_complete(file.parent_path(), file.filename().native(), name, *bytes)) continue;
    const std::unique_lock lock(impl_->mutex);
    Impl::insert(name, impl_->stages[std::string(stage)]);
  }
  return find(stage, key);
}

std::optional<Bytes> FolderStore::image(std::string_view stage, const Digest& key) {
  return impl_->read<Bytes>(stage, key, [](Bytes bytes, const ArtefactName& name) {
    std::string fault = damage(bytes, name);
    return std::pair(std::move(bytes), std::move(fault));
  });
}

std::optional<Arrays> FolderStore::load(std::string_view stage, const Digest& key) {
  return impl_->read<Arrays>(stage, key, [&](const Bytes& bytes, const ArtefactName& name) {
    Inspection inspection = inspect_artefact(bytes, stage, name);
    return std::pair(inspection.content ? std::move(inspection.content->arrays) : Arrays(),
                     std::move(inspection.fault));
  });
}

void FolderStore::prepare() {
  std::call_once(impl_->prepared, [&] { prepare_cache(impl_->folder); });
}

Digest FolderStore::save(const Recipe& recipe, std::string_view kind, const Arrays& arrays,
                         const ArtefactNote& note) {
  const Digest key = key_of(recipe);
  const Digest content = content_digest(arrays);
  const Bytes image = hdf5_image({arrays, describe(recipe, kind, key, content, note)});
  const ArtefactName name{item_label(note.item), key, content, checksum(image), image.size()};
  const fs::path target = impl_->path(recipe.stage, name);
  prepare();
  std::error_code error;
  if (!fs::exists(impl_->folder / kScratchFolder, error)) prepare_cache(impl_->folder);  // removed meanwhile
  make_folder(target.parent_path(), "choose another cache with --cache");
  UnfinishedFile file(impl_->folder / kScratchFolder);
  file.append(image);
  file.finish_unsynced(target);
  const std::unique_lock lock(impl_->mutex);
  impl_->is_synced = false;
  Impl::insert(name, impl_->stages[recipe.stage]);
  return content;
}

void FolderStore::sync() {
  if (!impl_->is_synced.exchange(true)) sync_file_system(impl_->folder);
}

std::unique_ptr<Claim> FolderStore::claim(std::string_view work) { return claim_in(impl_->folder, work); }
bool FolderStore::is_claimed(std::string_view work) const { return is_claimed_in(impl_->folder, work); }

std::optional<fs::path> FolderStore::path(std::string_view stage, const Digest& key) const {
  const std::shared_lock lock(impl_->mutex);
  const ArtefactName* entry = impl_->entry(stage, key);
  return entry == nullptr ? std::nullopt : std::optional(impl_->path(stage, *entry));
}

std::optional<std::uint64_t> FolderStore::bytes_of(std::string_view stage, const Digest& key) const {
  const std::shared_lock lock(impl_->mutex);
  const ArtefactName* entry = impl_->entry(stage, key);
  return entry == nullptr ? std::nullopt : std::optional<std::uint64_t>(entry->size);
}

std::vector<FolderStore::Usage> FolderStore::usage() const {
  const std::shared_lock lock(impl_->mutex);
  std::vector<Usage> result;
  for (const auto& [stage, entries] : impl_->stages) {
    Usage usage{stage, entries.by_key.size(), 0};
    for (const auto& [key, entry] : entries.by_key) usage.bytes += entry.size;
    result.push_back(usage);
  }
  return result;
}

}  // namespace salbench
