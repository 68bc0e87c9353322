// SPDX-License-Identifier: GPL-3.0-or-later
// Contents of a cache folder:
//   CACHEDIR.TAG                        marks the folder as a cache, and holds the format
//   <2 digits>/<family>.<checksum>.h5   segments, by a digest of the family's name
//   set/<checksum>.h5                   segments of what is made of all families
//   claims                              empty; processes lock bytes of it (cache/claim.cpp)
//   checked                             empty; when it last changed, all segments were sound
//   tmp/                                files being written
//   *.damaged                           segments in which damage was found: never read, removed by gc
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/digest.h"

namespace salbench {

inline constexpr std::string_view kScratchFolder = "tmp";
inline constexpr std::string_view kClaimsFile = "claims";

struct SegmentName {
  std::string label;  // of the family; empty: of all
  std::uint64_t checksum = 0;

  std::string text() const;
};
std::optional<SegmentName> parse_segment_name(std::string_view file_name);

// Below the cache's folder: of a family's segments, and of all of them.
std::filesystem::path segment_folder(std::string_view label);
const std::vector<std::filesystem::path>& segment_folders();

// Renames a damaged segment to *.damaged. True if it has gone, whoever was first; false where the folder may
// not be written to.
bool set_aside(const std::filesystem::path& segment);

// When all segments were last known to be sound, in ns since 1970; 0 if never. A run reads those that have
// changed since to their end before it trusts them.
std::int64_t last_check(const std::filesystem::path& cache);
void note_check(const std::filesystem::path& cache);    // now; does nothing where it may not write
void forget_check(const std::filesystem::path& cache);  // so that the next run reads every segment

// Throws StorageError if a newer program wrote the folder; a folder without a tag passes.
void check_format(const std::filesystem::path& folder);

// True of a folder that a salbench, this one or another, made as a cache.
bool is_cache(const std::filesystem::path& folder);

// Throws StorageError unless the folder is a cache that this program knows. Called before files are inspected
// or removed, so that a mistyped folder is left alone.
void require_cache(const std::filesystem::path& folder);

// Makes the folder a cache. Throws StorageError if it cannot be written to.
void prepare_cache(const std::filesystem::path& folder);

// Segments, by path. Throws StorageError if a folder cannot be listed to its end; a missing one is empty.
std::vector<std::filesystem::path> list_segments(const std::filesystem::path& folder);
std::vector<std::filesystem::path> list_segments(const std::filesystem::path& folder, std::string_view label);
std::vector<std::filesystem::path> list_damaged(const std::filesystem::path& folder);  // *.damaged
std::size_t count_other_files(const std::filesystem::path& folder);  // neither segments nor the cache's own

}  // namespace salbench
