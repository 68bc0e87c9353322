// SPDX-License-Identifier: GPL-3.0-or-later
// Contents of a cache folder:
//   CACHEDIR.TAG                        marks the folder as a cache, and holds the format
//   <2 digits>/<family>.<checksum>.h5   segments, by a digest of the family's name
//   set/<checksum>.h5                   segments of what is made of all families
//   claims                              empty; processes lock bytes of it (cache/claim.cpp)
//   tmp/                                files being written
//   damaged/                            quarantined segments; and an empty file <segment>.<key> for each
//                                       damaged artefact of a segment that lies where it was
// Folders of other names are the stages of a cache of format 1 (cache/format1.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "io/digest.h"

namespace salbench {

inline constexpr std::string_view kScratchFolder = "tmp";
inline constexpr std::string_view kDamagedFolder = "damaged";
inline constexpr std::string_view kClaimsFile = "claims";

struct SegmentName {
  std::string label;  // of the family; empty: of all
  std::uint64_t checksum = 0;

  std::string text() const;
};
std::optional<SegmentName> parse_segment_name(std::string_view file_name);

// A damaged artefact of a segment whose head is sound.
struct DamagedName {
  std::string segment;  // name of the file
  Digest key;

  auto operator<=>(const DamagedName&) const = default;
  std::string text() const { return segment + "." + key.hex(); }
};
std::optional<DamagedName> parse_damaged_name(std::string_view file_name);
std::set<DamagedName> list_damaged(const std::filesystem::path& folder);

// Below the cache's folder: of a family's segments, and of all of them.
std::filesystem::path segment_folder(std::string_view label);
const std::vector<std::filesystem::path>& segment_folders();

bool is_own_name(std::string_view name);  // of a file or folder in the cache's folder, in this format

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
std::size_t count_other_files(const std::filesystem::path& folder);  // neither segments nor the cache's own

}  // namespace salbench
