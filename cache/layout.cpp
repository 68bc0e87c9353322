// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/layout.h"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr int kFormat = 1;  // raised when the layout of the folder or of its names changes
constexpr std::string_view kTagName = "CACHEDIR.TAG";  // backup programs skip folders that hold it
constexpr std::string_view kTagSignature = "Signature: 8a477f597d28d172789f06886806bc55";
constexpr std::string_view kFormatLine = "# salbench cache, format ";

std::string tag_text(const fs::path& folder) {
  const auto tag = read_bytes(folder / kTagName);
  return tag ? std::string(reinterpret_cast<const char*>(tag->data()), tag->size()) : std::string();
}

bool is_own(std::string_view name) {
  return name == kScratchFolder || name == kDamagedFolder || name == kTagName || name == kClaimsFile;
}

// Artefacts lie one level below the folder of their stage; any other file is foreign.
void list_below(const fs::path& folder, ShardFolder shard, int depth, CacheListing& listing) {
  constexpr int kShardDepth = 1;
  std::vector<std::string> folders;
  visit_names(folder, [&](std::string_view name, bool is_folder) {
    if (is_folder) {
      folders.emplace_back(name);
    } else if (depth == kShardDepth && parse_artefact_name(name)) {
      ++shard.artefacts;
    } else {
      ++listing.others;
    }
  });
  listing.artefacts += shard.artefacts;
  if (shard.artefacts > 0) listing.shards.push_back(shard);
  std::sort(folders.begin(), folders.end());
  for (const std::string& below : folders)
    list_below(folder / below, {shard.stage, below}, depth + 1, listing);
}

}  // namespace

fs::path shard_of(std::string_view stage, const Digest& key) {
  return fs::path(stage) / key.hex().substr(0, 2);
}

void check_format(const fs::path& folder) {
  const std::string text = tag_text(folder);
  const std::size_t line = text.find(kFormatLine);
  const int format = line == std::string::npos ? 0 : std::atoi(text.c_str() + line + kFormatLine.size());
  if (format > kFormat)
    throw StorageError(
        fmt::format("{}: written by a newer salbench (cache format {}, this one knows {}); "
                    "use that version, or another folder with {}",
                    folder.string(), format, kFormat, as_option("cache")));
}

bool is_cache(const fs::path& folder) {
  const std::string text = tag_text(folder);
  return text.starts_with(kTagSignature) && text.find(kFormatLine) != std::string::npos;
}

void require_cache(const fs::path& folder) {
  check_format(folder);
  if (!is_cache(folder))
    throw StorageError(fmt::format("{}: not a salbench cache ({} is missing); choose one with {}",
                                   folder.string(), kTagName, as_option("cache")));
}

void prepare_cache(const fs::path& folder) {
  make_folder(folder / kScratchFolder, "choose another cache with " + as_option("cache"));
  // Writing the tag each time is the probe for a full or read-only folder, before any work is done.
  const std::string tag = fmt::format("{}\n{}{}\n", kTagSignature, kFormatLine, kFormat);
  UnfinishedFile file(folder / kScratchFolder);
  file.append(std::as_bytes(std::span(tag)));
  file.finish(folder / kTagName);
}

std::vector<std::string> list_stages(const fs::path& folder) {
  std::vector<std::string> stages;
  visit_names(folder, [&](std::string_view name, bool is_folder) {
    if (is_folder && !is_own(name)) stages.emplace_back(name);
  });
  std::sort(stages.begin(), stages.end());
  return stages;
}

CacheListing list_cache(const fs::path& folder) {
  CacheListing listing;
  visit_names(folder, [&](std::string_view name, bool is_folder) {
    if (!is_folder && !is_own(name)) ++listing.others;
  });
  for (const std::string& stage : list_stages(folder)) list_below(folder / stage, {stage, {}}, 0, listing);
  return listing;
}

std::vector<ArtefactFile> list_shard(const fs::path& folder, const ShardFolder& shard) {
  std::vector<ArtefactFile> files;
  for (FolderEntry& entry : list_folder(folder / shard.stage / shard.name))
    if (auto name = parse_artefact_name(entry.path.filename().native()); name && !entry.is_folder)
      files.push_back({std::move(entry.path), shard.stage, std::move(*name)});
  return files;
}

std::vector<ArtefactName> find_artefacts(const fs::path& folder, std::string_view stage, const Digest& key) {
  std::vector<ArtefactName> found;
  visit_names(folder / shard_of(stage, key), [&](std::string_view file, bool) {
    if (const auto name = parse_artefact_name(file); name && name->key == key) found.push_back(*name);
  });
  return found;
}

}  // namespace salbench
