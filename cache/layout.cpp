#include "cache/layout.h"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "cache/files.h"
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

void list_stage(const fs::path& folder, CacheListing& listing) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_directory()) continue;
    const fs::path within = entry.path().lexically_relative(folder);
    const auto name = parse_artefact_name(entry.path().filename().string());
    const bool in_a_shard = std::distance(within.begin(), within.end()) == 2;
    if (name && in_a_shard)
      listing.artefacts.push_back({entry.path(), folder.filename().string(), *name});
    else
      listing.others.push_back(entry.path());
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
    throw StorageError(
        fmt::format("{}: is no cache of salbench (it has no {} of its own); name one with --cache",
                    folder.string(), kTagName));
}

void prepare_cache(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder / kScratchFolder, error);
  if (error)
    throw StorageError(
        fmt::format("{}: the cache folder cannot be created or written to: {}; choose another with --cache",
                    folder.string(), error.message()));
  // Writing the tag each time is the probe for a full or read-only folder, before any work is done.
  const std::string tag = fmt::format("{}\n{}{}\n", kTagSignature, kFormatLine, kFormat);
  write_bytes_atomically(folder / kScratchFolder, folder / kTagName, std::as_bytes(std::span(tag)));
}

CacheListing list_cache(const fs::path& folder) {
  CacheListing listing;
  try {
    for (const auto& entry : fs::directory_iterator(folder)) {
      const std::string name = entry.path().filename().string();
      if (name == kScratchFolder || name == kDamagedFolder || name == kTagName || name == kClaimsFile)
        continue;
      if (entry.is_directory())
        list_stage(entry.path(), listing);
      else
        listing.others.push_back(entry.path());
    }
  } catch (const fs::filesystem_error& error) {
    throw StorageError(fmt::format("{}: cannot be listed: {}", folder.string(), error.code().message()));
  }
  std::sort(listing.artefacts.begin(), listing.artefacts.end(),
            [](const ArtefactFile& a, const ArtefactFile& b) { return a.path < b.path; });
  std::sort(listing.others.begin(), listing.others.end());
  return listing;
}

}  // namespace salbench
