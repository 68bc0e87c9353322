// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/format1.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "cache/layout.h"
#include "io/file.h"
#include "io/hdf5/hdf5_file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kOldSuffix = ".h5";

template <class T>
T attribute(const Attributes& attributes, std::string_view name) {
  const AttributeValue* value = find_attribute(attributes, name);
  const T* typed = value == nullptr ? nullptr : std::get_if<T>(value);
  if (typed == nullptr) throw InputError("an attribute of its recipe is missing");
  return *typed;
}

Recipe recipe_from(const Attributes& attributes) {
  auto inputs = inputs_from_text(attribute<std::string>(attributes, "inputs"));
  const auto version = attribute<std::int64_t>(attributes, "stage_version");
  if (!inputs || !std::in_range<std::int32_t>(version)) throw InputError("its recipe is malformed");
  return {attribute<std::string>(attributes, "stage"), static_cast<std::int32_t>(version),
          attribute<std::string>(attributes, "options"), attribute<std::string>(attributes, "seed"),
          std::move(*inputs)};
}

// Those that no result is made of: of the run.
Attributes others(Attributes attributes) {
  constexpr std::array<std::string_view, 10> kOwn = {"item", "kind",   "stage", "stage_version", "options",
                                                     "seed", "inputs", "key",   "content",       "seconds"};
  std::erase_if(attributes, [&](const auto& entry) { return std::ranges::count(kOwn, entry.first) > 0; });
  return attributes;
}

std::optional<Hdf5Content> sound_content(const OldArtefact& old) {
  const auto bytes = read_bytes(old.path);
  if (!bytes) return {};
  if (bytes->size() != old.size)
    throw InputError(fmt::format("truncated: {} of {} bytes", bytes->size(), old.size));
  if (checksum(*bytes) != old.checksum) throw InputError("checksum mismatch");
  Hdf5Content content = hdf5_content(*bytes, old.path.filename().string());
  if (content_digest(content.arrays) != old.content) throw InputError("its content does not match its name");
  return content;
}

}  // namespace

std::optional<OldArtefact> old_artefact_at(const fs::path& path) {
  const std::string text = path.filename().string();
  std::string_view name = text;
  if (!name.ends_with(kOldSuffix)) return {};
  name.remove_suffix(kOldSuffix.size());
  std::array<std::string_view, 5> parts;  // item, key, content, checksum, size
  for (std::size_t i = parts.size(); i-- > 1;) {
    const std::size_t dot = name.rfind('.');
    if (dot == std::string_view::npos) return {};
    parts[i] = name.substr(dot + 1);
    name = name.substr(0, dot);
  }
  const auto key = digest_from_hex(parts[1]), content = digest_from_hex(parts[2]);
  const auto sum = number_from_hex(parts[3]), size = number_from_hex(parts[4]);
  if (!key || !content || !sum || !size) return {};
  return OldArtefact{
      path, path.parent_path().parent_path().filename(), std::string(name), *key, *content, *sum, *size};
}

Digest old_remark_key(std::string_view stage, const Digest& key) {
  return key_of({std::string(kOldRemarks), 1, {}, {}, {{std::string(stage), key}}});
}

std::string old_remark(const Artefact& remark) {
  const Arrays arrays = arrays_of(remark);
  const Array* text = find_array(arrays, "text");
  const auto* bytes = text == nullptr ? nullptr : std::get_if<std::vector<std::uint8_t>>(&text->values);
  return bytes == nullptr ? std::string() : std::string(bytes->begin(), bytes->end());
}

std::vector<fs::path> list_old_artefacts(const fs::path& folder) {
  std::vector<fs::path> found;
  const auto folders_in = [](const fs::path& above) {
    std::vector<FolderEntry> entries = list_folder(above);
    std::erase_if(entries, [](const FolderEntry& entry) { return !entry.is_folder; });
    return entries;
  };
  for (const FolderEntry& stage : folders_in(folder)) {
    if (is_own_name(stage.path.filename().native())) continue;
    for (const FolderEntry& shard : folders_in(stage.path))
      for (FolderEntry& entry : list_folder(shard.path))
        if (!entry.is_folder && old_artefact_at(entry.path)) found.push_back(std::move(entry.path));
  }
  return found;
}

std::optional<Artefact> read_old_artefact(const OldArtefact& old) {
  const auto content = sound_content(old);
  if (!content) return {};
  const Attributes& attributes = content->attributes;
  Artefact artefact =
      artefact_of(recipe_from(attributes), attribute<std::string>(attributes, "kind"), content->arrays,
                  {attribute<std::string>(attributes, "item"),
                   attribute<double>(attributes, "seconds"),
                   {},
                   others(attributes)});
  if (artefact.key != old.key || artefact.recipe.stage != old.stage)
    throw InputError("its key is not that of its recipe");
  return artefact;
}

}  // namespace salbench
