// SPDX-License-Identifier: GPL-3.0-or-later
// Folders for files that a command reads and writes.
#pragma once

#include <filesystem>
#include <string>

#include <unistd.h>

#include "io/descriptor.h"

namespace salbench {

// A new folder below TMPDIR, removed with all that is in it by the process that made it. Throws StorageError.
class ScratchFolder {
 public:
  ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder();

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  Descriptor lock_{-1};  // on the folder; dies with the process
  pid_t owner_ = ::getpid();
};

// A message of a command without the names of such folders, which are others each time and soon gone:
// "shape.ply".
std::string without_scratch_folders(std::string message);

// Removes the folders below TMPDIR whose process is dead, of this user and on any file system that has locks.
void remove_abandoned_scratch();

}  // namespace salbench
