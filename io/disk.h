// SPDX-License-Identifier: GPL-3.0-or-later
// The disk below a folder: what is free, and whether it has locks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>

namespace salbench {

// The folder itself, or the nearest one above it that exists.
std::filesystem::path existing_folder(const std::filesystem::path& folder);

struct FreeSpace {
  static constexpr std::uint64_t kNoLimit = std::numeric_limits<std::int64_t>::max();
  std::uint64_t bytes = kNoLimit;  // for this user; what a quota leaves is not known
  std::uint64_t files = kNoLimit;
};
FreeSpace free_space(const std::filesystem::path& existing);

// True if a lock that one holds is refused to another; nothing if no file can be written into the folder. On
// some network disks locks hold on one machine only, which this does not see.
std::optional<bool> locks_hold(const std::filesystem::path& folder);

}  // namespace salbench
