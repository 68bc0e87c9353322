// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/layout.h"

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

bool is_own(const std::string& name) {
  return name == kScratchFolder || name == kDamagedFolder || name == kTagName || name == kClaimsFile;
}

// Artefacts lie one level below the folder of their stage; any other file is foreign.
void list_below(const fs::path& folder, const std::string& stage, int depth, CacheListing& listing) {
  constexpr int kShardDepth = 1;
  for (FolderEntry& entry : list_folder(folder)) {
    if (entry.is_folder) {
      list_below(entry.path, stage, depth + 1, listing);
      continue;
    }
    const auto name = parse_artefact_name(entry.path.filename().native());
    if (name && depth == kShardDepth)
      listing.artefacts.push_back({std::move(entry.path), stage, *name});
    else
      listing.others.push_back(std::move(entry.path));
  }
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
                    "use that version, or another folder with --cache",
                    folder.string(), format, kFormat));
}

void require_cache(const fs::path& folder) {
  check_format(folder);
  const std::string text = tag_text(folder);
  if (!text.starts_with(kTagSignature) || text.find(kFormatLine) == std::string::npos)
    throw StorageError(fmt::format("{}: not a salbench cache ({} is missing); choose one with --cache",
                                   folder.string(), kTagName));
}

void prepare_cache(const fs::path& folder) {
  make_folder(folder / kScratchFolder, "choose another cache with --cache");
  // Writing the tag each time is the probe for a full or read-only folder, before any work is done.
  const std::string tag = fmt::format("{}\n{}{}\n", kTagSignature, kFormatLine, kFormat);
  UnfinishedFile file(folder / kScratchFolder);
  file.append(std::as_bytes(std::span(tag)));
  file.finish(folder / kTagName);
}

std::vector<std::string> list_stages(const fs::path& folder) {
  std::vector<std::string> stages;
  for (const FolderEntry& entry : list_folder(folder))
    if (entry.is_folder && !is_own(entry.path.filename())) stages.push_back(entry.path.filename());
  return stages;
}

CacheListing list_stage(const fs::path& folder, const std::string& stage) {
  CacheListing listing;
  list_below(folder / stage, stage, 0, listing);
  return listing;
}

CacheListing list_cache(const fs::path& folder) {
  CacheListing listing;
  for (const FolderEntry& entry : list_folder(folder))
    if (!entry.is_folder && !is_own(entry.path.filename())) listing.others.push_back(entry.path);
  for (const std::string& stage : list_stages(folder)) list_below(folder / stage, stage, 0, listing);
  return listing;
}

std::vector<ArtefactName> find_artefacts(const fs::path& folder, std::string_view stage, const Digest& key) {
  std::vector<ArtefactName> found;
  for (const FolderEntry& entry : list_folder(folder / shard_of(stage, key)))
    if (const auto name = parse_artefact_name(entry.path.filename().native()); name && name->key == key)
      found.push_back(*name);
  return found;
}

}  // namespace salbench
