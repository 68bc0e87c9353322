// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/verify.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "cache/layout.h"
#include "io/file.h"
#include "stages/core/errors.h"
#include "stages/core/parallel.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

template <class T>
std::optional<T> attribute(const Attributes& attributes, std::string_view name) {
  const AttributeValue* value = find_attribute(attributes, name);
  const T* typed = value == nullptr ? nullptr : std::get_if<T>(value);
  return typed == nullptr ? std::nullopt : std::optional(*typed);
}

// Describes where the content contradicts the name; empty if they agree.
std::string contradiction(const Hdf5Content& content, std::string_view stage, const ArtefactName& name) {
  if (content_digest(content.arrays) != name.content) return "its content does not match its name";
  const auto recipe = recipe_from(content.attributes);
  if (!recipe) return "an attribute of its recipe is missing";
  if (recipe->stage != stage) return fmt::format("its attributes name stage {}", recipe->stage);
  if (key_of(*recipe) != name.key) return "its key is not that of its recipe";
  if (item_label(attribute<std::string>(content.attributes, "item").value_or("")) != name.item)
    return "its attributes name another item";
  return {};
}

// Describes what is wrong with one artefact, and counts it; empty if it is sound or gone.
std::string fault_of(const ArtefactFile& file, const fs::path& folder, Verification& result) try {
  const auto bytes = read_bytes(file.path);
  if (!bytes) return {};
  ++result.artefacts;
  result.bytes += bytes->size();
  std::string fault = inspect_artefact(*bytes, file.stage, file.name).fault;
  if (fault.empty() && file.path.parent_path() != folder / shard_of(file.stage, file.name.key))
    fault = "it lies in the folder of another key";
  return fault;
} catch (const StorageError& error) {
  ++result.artefacts;
  return error.what();
}

// Sound artefacts of one key lie in one shard.
Verification verify_shard(const fs::path& folder, const ShardFolder& shard) {
  Verification result;
  std::map<Digest, const ArtefactFile*> sound;
  const std::vector<ArtefactFile> files = list_shard(folder, shard);
  for (const ArtefactFile& file : files) {
    std::string fault = fault_of(file, folder, result);
    if (fault.empty()) {
      const ArtefactFile* first = sound.try_emplace(file.name.key, &file).first->second;
      if (first->name.content != file.name.content)
        fault = "another content under the key of " + first->path.filename().string();
    }
    if (!fault.empty()) result.faults.push_back({file.path, std::move(fault)});
  }
  return result;
}

}  // namespace

std::optional<Recipe> recipe_from(const Attributes& attributes) {
  const auto stage = attribute<std::string>(attributes, "stage");
  const auto version = attribute<std::int64_t>(attributes, "stage_version");
  const auto options = attribute<std::string>(attributes, "options");
  const auto seed = attribute<std::string>(attributes, "seed");
  const auto inputs = inputs_from_text(attribute<std::string>(attributes, "inputs").value_or("?"));
  if (!stage || !version || !options || !seed || !inputs || !std::in_range<std::int32_t>(*version)) return {};
  return Recipe{*stage, static_cast<std::int32_t>(*version), *options, *seed, *inputs};
}

std::string damage(std::span<const std::byte> bytes, const ArtefactName& name) {
  if (bytes.size() != name.size) return fmt::format("truncated: {} of {} bytes", bytes.size(), name.size);
  return checksum(bytes) == name.checksum ? "" : "checksum mismatch";
}

Inspection inspect_artefact(std::span<const std::byte> bytes, std::string_view stage,
                            const ArtefactName& name) try {
  std::string fault = damage(bytes, name);
  if (!fault.empty()) return {{}, std::move(fault)};
  Hdf5Content content = hdf5_content(bytes, name.item);
  fault = contradiction(content, stage, name);
  if (!fault.empty()) return {{}, std::move(fault)};
  return {std::move(content), {}};
} catch (const InputError& error) {
  return {{}, error.what()};
}

Verification verify_cache(const fs::path& folder, const std::atomic<bool>& stop, Progress& progress) {
  require_cache(folder);
  const CacheListing listing = list_cache(folder);
  std::vector<Verification> found(listing.shards.size());
  progress.begin("verifying", listing.artefacts);
  parallel_ranges(found.size(), 1, [&](std::size_t i, std::size_t) {
    if (stop) return;
    found[i] = verify_shard(folder, listing.shards[i]);
    for (std::size_t n = found[i].artefacts; n > 0; --n) progress.item_done();
  });
  progress.end();
  Verification result;
  result.others = listing.others;
  for (Verification& part : found) {
    result.artefacts += part.artefacts;
    result.bytes += part.bytes;
    std::ranges::move(part.faults, std::back_inserter(result.faults));
  }
  return result;
}

}  // namespace salbench
