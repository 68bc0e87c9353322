// SPDX-License-Identifier: GPL-3.0-or-later
// Contents of a cache folder:
//   CACHEDIR.TAG                        marks the folder as a cache; contains the format
//   <2 digits>/<family>.<checksum>.h5   segments, in folders by a digest of the family's name
//   set/<checksum>.h5                   segments of results over all families
//   claims                              empty; processes lock its bytes (cache/claim.cpp)
//   checked                             empty; at its time stamp, all segments were undamaged
//   tmp/                                files being written
//   *.damaged                           damaged segments: never read, removed by gc
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
  std::string label;  // the family's label; empty: over all families
  std::uint64_t checksum = 0;

  std::string text() const;
};
std::optional<SegmentName> parse_segment_name(std::string_view file_name);

// Relative to the cache folder: folder of a family's segments, and all segment folders.
std::filesystem::path segment_folder(std::string_view label);
const std::vector<std::filesystem::path>& segment_folders();

// Renames a damaged segment to *.damaged. True if it is gone, even by another process; false if the folder is
// not writable.
bool set_aside(const std::filesystem::path& segment);

// Last time at which all segments were known to be undamaged, in ns since 1970; 0 if never. A run fully reads
// segments that changed later before it trusts them.
std::int64_t last_check(const std::filesystem::path& cache);
void note_check(const std::filesystem::path& cache);    // sets it to now, if the folder is writable
void forget_check(const std::filesystem::path& cache);  // makes the next run read every segment

// Throws StorageError if a newer program wrote the folder. Accepts a folder without a tag.
void check_format(const std::filesystem::path& folder);

// True for a cache folder made by any version of salbench.
bool is_cache(const std::filesystem::path& folder);

// Throws StorageError unless the folder is a cache of a known format. Called before inspecting or removing
// files, which protects a mistyped folder.
void require_cache(const std::filesystem::path& folder);

// Turns the folder into a cache. Throws StorageError if it is not writable.
void prepare_cache(const std::filesystem::path& folder);

// Segments, sorted by path; none without a folder. Throws StorageError if it cannot be listed completely.
std::vector<std::filesystem::path> list_segments(const std::filesystem::path& folder);
std::vector<std::filesystem::path> list_segments(const std::filesystem::path& folder, std::string_view label);
std::vector<std::filesystem::path> list_damaged(const std::filesystem::path& folder);  // *.damaged
std::size_t count_other_files(const std::filesystem::path& folder);  // neither segments nor the cache's own

}  // namespace salbench
