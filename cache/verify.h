// SPDX-License-Identifier: GPL-3.0-or-later
// Checks every artefact in a cache folder.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "stages/core/progress.h"

namespace salbench {

struct Fault {
  std::filesystem::path file;
  std::string what;
};

struct Verification {
  std::size_t artefacts = 0;  // all that were checked
  std::uint64_t bytes = 0;    // total size of the files with artefacts
  std::size_t others = 0;     // foreign files, not checked
  std::vector<Fault> faults;  // by file
};

// Reads every segment of the cache without changing any; if one is damaged, the next run checks all of them.
// Skips files that another process removes in the meantime. Ends early once `stop` is set. Throws
// StorageError if the folder is not a cache or cannot be listed.
Verification verify_cache(const std::filesystem::path& folder, const std::atomic<bool>& stop,
                          Progress& progress);

}  // namespace salbench
