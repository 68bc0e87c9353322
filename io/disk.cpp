// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/disk.h"

#include <cerrno>

#include <fcntl.h>
#include <sys/statvfs.h>

#include "io/descriptor.h"
#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {

namespace fs = std::filesystem;

fs::path existing_folder(const fs::path& folder) {
  std::error_code error;
  fs::path found = fs::absolute(folder, error);
  while (!fs::is_directory(found, error) && found.has_relative_path()) found = found.parent_path();
  const fs::path plain = fs::canonical(found, error);
  return error ? found : plain;
}

FreeSpace free_space(const fs::path& existing) {
  struct statvfs status {};
  if (::statvfs(existing.c_str(), &status) != 0 || status.f_blocks == 0) return {};  // it does not say
  // Btrfs and others have no limit on files, and say 0.
  return {std::uint64_t{status.f_bavail} * status.f_frsize,
          status.f_files == 0 ? FreeSpace::kNoLimit : std::uint64_t{status.f_favail}};
}

std::optional<bool> locks_hold(const fs::path& folder) try {
  const UnfinishedFile held(folder);  // it has the lock of its file
  const Descriptor other(::open(held.path().c_str(), O_RDWR | O_CLOEXEC));
  if (other.get() < 0) return {};
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  return ::fcntl(other.get(), F_OFD_SETLK, &whole) != 0 && (errno == EAGAIN || errno == EACCES);
} catch (const StorageError&) {
  return {};
}

}  // namespace salbench
