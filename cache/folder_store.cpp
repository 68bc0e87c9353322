// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/folder_store.h"

#include <algorithm>
#include <atomic>
#include <bitset>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "cache/artefact_name.h"
#include "cache/layout.h"
#include "cache/nesting.h"
#include "cache/verify.h"
#include "io/file.h"
#include "io/hdf5/hdf5_file.h"
#include "stages/core/errors.h"
#include "stages/core/parallel.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

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
  NameIndex names;
  std::mutex listing;  // of `listed`, which on_demand needs
  std::map<std::string, std::bitset<kShards>, std::less<>> listed;
  std::mutex preparing;  // call_once would hang under ThreadSanitizer where preparing throws
  bool prepared = false;
  pid_t thread = ::gettid();           // that wants what is computed
  std::atomic<bool> is_synced = true;  // nothing was saved since the last sync

  fs::path path(std::string_view stage, const ArtefactName& name) const {
    return folder / shard_of(stage, name.key) / name.text();
  }

  // A file whose size is not the one in its name was truncated by others: not listed, so a miss. Moved aside,
  // it is not reported again at each listing.
  bool is_complete(const fs::path& shard, std::string_view file, const ArtefactName& name,
                   std::uintmax_t bytes) const {
    if (bytes == name.size) return true;
    quarantine(shard / file, fmt::format("truncated: {} of {} bytes", bytes, name.size));
    return false;
  }

  void list_shard(std::string_view stage, std::size_t number) {
    const fs::path shard = folder / shard_of(stage, first_key(number));
    std::vector<ArtefactName> found;
    visit_files(shard, [&](std::string_view file, std::uintmax_t bytes) {
      if (auto name = parse_artefact_name(file);
          name && shard_number(name->key) == number && is_complete(shard, file, *name, bytes))
        found.push_back(std::move(*name));
    });
    std::ranges::sort(found, {}, &ArtefactName::key);
    names.insert(stage, found);
  }

  void list_shards(std::string_view stage) {
    parallel_ranges(kShards, kShardGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t shard = first; shard < last; ++shard) list_shard(stage, shard);
    });
  }

  // Most of the time of a run with nothing to do: several stages at a time, and several shards of each.
  void list_all() {
    const std::vector<std::string> stages = list_stages(folder);
    parallel_ranges(stages.size(), 1, [&](std::size_t i, std::size_t) { list_shards(stages[i]); });
  }

  bool needs_listing(std::string_view stage, std::size_t shard) {
    const std::lock_guard lock(listing);
    return !listed[std::string(stage)][shard];
  }

  // Before a question about one key, or about all of a stage. Two threads may list the same shard.
  void list_for(std::string_view stage, const std::optional<Digest>& key) {
    if (access != Access::on_demand) return;
    for (std::size_t shard = 0; shard < kShards; ++shard) {
      if ((key && shard != shard_number(*key)) || !needs_listing(stage, shard)) continue;
      list_shard(stage, shard);
      const std::lock_guard lock(listing);
      listed[std::string(stage)].set(shard);
    }
  }

  std::optional<ArtefactName> find(std::string_view stage, const Digest& key) {
    list_for(stage, key);
    return names.find(stage, key);
  }

  // A file that is gone (another process collects, or quarantines the same file) needs no warning.
  void quarantine(const fs::path& file, std::string_view why) const {
    std::error_code error;
    if (access != Access::read_write) {
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
    const std::optional<ArtefactName> name = find(stage, key);
    if (!name) return {};
    const fs::path file = path(stage, *name);
    if (auto bytes = read_bytes(file)) {
      auto [result, fault] = parse(std::move(*bytes), *name);
      if (fault.empty()) return std::move(result);
      quarantine(file, fault);
    }
    names.erase(stage, key);
    return {};
  }
};

FolderStore::FolderStore(fs::path folder, Access access) : impl_(std::make_unique<Impl>()) {
  impl_->folder = std::move(folder);
  impl_->access = access;
  std::error_code error;
  if (fs::exists(impl_->folder, error) && !fs::is_directory(impl_->folder, error))
    throw StorageError(fmt::format("{}: is not a folder; choose another with {}", impl_->folder.string(),
                                   as_option("cache")));
  check_format(impl_->folder);
  if (access == Access::read_write)
    visit_abandoned(impl_->folder / kScratchFolder, [&](const fs::path& file) { fs::remove(file, error); });
  if (access != Access::on_demand) impl_->list_all();
}

FolderStore::~FolderStore() = default;

std::optional<Digest> FolderStore::find(std::string_view stage, const Digest& key) const {
  const auto name = impl_->find(stage, key);
  return name ? std::optional(name->content) : std::nullopt;
}

bool FolderStore::has_item(std::string_view stage, std::string_view item) const {
  impl_->list_for(stage, {});
  return impl_->names.has_item(stage, item);
}

std::optional<Digest> FolderStore::refresh_and_find(std::string_view stage, const Digest& key) {
  if (const auto content = find(stage, key)) return content;
  for (const ArtefactName& name : find_artefacts(impl_->folder, stage, key)) {
    const fs::path file = impl_->path(stage, name);
    const auto bytes = size_of_file(file);
    if (!bytes || !impl_->is_complete(file.parent_path(), file.filename().native(), name, *bytes)) continue;
    impl_->names.insert(stage, {&name, 1});
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
  const std::lock_guard lock(impl_->preparing);
  if (!impl_->prepared) prepare_cache(impl_->folder);
  impl_->prepared = true;
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
  make_folder(target.parent_path(), "choose another cache with " + as_option("cache"));
  UnfinishedFile file(impl_->folder / kScratchFolder);
  file.append(image);
  file.finish_unsynced(target);
  impl_->is_synced = false;
  impl_->names.insert(recipe.stage, {&name, 1});
  return content;
}

void FolderStore::sync() {
  if (!impl_->is_synced.exchange(true)) sync_file_system(impl_->folder);
}

std::unique_ptr<Claim> FolderStore::claim(std::string_view work) { return claim_in(impl_->folder, work); }
bool FolderStore::is_claimed(std::string_view work) const { return is_claimed_in(impl_->folder, work); }

void FolderStore::before_waiting() const {
  if (is_inside_function(impl_->folder, impl_->thread))
    throw ConfigError(fmt::format(
        "{}: a function that computes a map for a run has started this run over the same cache, which would "
        "wait for ever for what the first one has begun: give it a cache of its own with {}",
        impl_->folder.string(), as_option("cache")));
}

std::optional<fs::path> FolderStore::path(std::string_view stage, const Digest& key) const {
  const auto name = impl_->find(stage, key);
  return name ? std::optional(impl_->path(stage, *name)) : std::nullopt;
}

std::optional<std::uint64_t> FolderStore::bytes_of(std::string_view stage, const Digest& key) const {
  const auto name = impl_->find(stage, key);
  return name ? std::optional(name->size) : std::nullopt;
}

std::vector<FolderStore::Usage> FolderStore::usage() const { return impl_->names.usage(); }

}  // namespace salbench
