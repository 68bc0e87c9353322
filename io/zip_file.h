// SPDX-License-Identifier: GPL-3.0-or-later
// ZIP archives: ours, whose bytes follow from what is in them, and anybody's, which are trusted nowhere.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace salbench {

struct ZipEntry {
  std::string name;  // "maps/52.npy"
  std::string bytes;
};

struct ZipLimits {
  std::size_t entries = 0;
  std::uint64_t bytes = 0;  // of all entries, unpacked
};

// An archive of these entries in their order, stored as they are and dated 1980: the same entries make the
// same bytes.
std::string zip_of(const std::vector<ZipEntry>& entries);

// The files in an archive, read in a child process with limits on time and memory. Nothing is written to
// disk. Throws InputError, one line that begins with the path: not an archive, damaged, truncated, encrypted;
// an entry that is a link, that is there twice, or whose name leaves the folder; more than the limits, as
// declared or as unpacked.
std::vector<ZipEntry> read_zip(const std::filesystem::path& path, const ZipLimits& limits);

}  // namespace salbench
