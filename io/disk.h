// SPDX-License-Identifier: GPL-3.0-or-later
// The disk below a folder: what file system it is, what is free, and what it does when it is tried.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace salbench {

// The folder itself, or the nearest one above it that exists.
std::filesystem::path existing_folder(const std::filesystem::path& folder);

struct Mount {
  std::string point, type, options;  // "/home", "nfs4", "rw,relatime,local_lock=none"
};
// The last mount that the path lies below; empty if there is none. `mounts`: the text of
// /proc/self/mountinfo; the path is absolute, without links.
Mount mount_of(std::string_view mounts, const std::filesystem::path& path);

bool is_network(const Mount& mount);
// True if locks are those of this machine alone, so that processes of others do not see them.
bool locks_stay_here(const Mount& mount);

struct FreeSpace {
  static constexpr std::uint64_t kNoLimit = std::numeric_limits<std::int64_t>::max();
  std::uint64_t bytes = kNoLimit;  // for this user; what a quota leaves is not known
  std::uint64_t files = kNoLimit;
};
FreeSpace free_space(const std::filesystem::path& existing);

struct DiskFacts {
  std::filesystem::path folder;  // that exists
  Mount mount;
  FreeSpace free;
  bool writable = false;
};
DiskFacts disk_facts(const std::filesystem::path& folder);

// Nothing where the system does not let it be tried.
struct DiskTrial {
  std::optional<double> sync_seconds, rename_seconds;  // medians of kDiskTrials files of kTrialBytes
  std::optional<bool> locks;  // a lock that one holds is refused to another that opens the same file
};
inline constexpr int kDiskTrials = 9;
inline constexpr std::size_t kTrialBytes = 64 * 1024;

// Writes files into the folder, as unfinished ones are named, and renames them.
DiskTrial try_disk(const std::filesystem::path& scratch);
// Writes files without names, so that any folder will do: nothing is seen or left behind, and nothing
// renamed.
DiskTrial try_disk_without_names(const std::filesystem::path& folder);

}  // namespace salbench
