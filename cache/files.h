// The few system calls that a crash-safe folder needs, each with an error that names the file.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/hdf5_file.h"

namespace salbench {

// The whole file; nothing where it is not there or cannot be read.
std::optional<Bytes> read_bytes(const std::filesystem::path& path);

// Writes a temporary file in `scratch`, syncs it, and renames it to `target` (same file system): afterwards
// the target is complete, whatever happens to the process. Throws StorageError.
void write_bytes_atomically(const std::filesystem::path& scratch, const std::filesystem::path& target,
                            std::span<const std::byte> bytes);

// What processes of this host left in `scratch` that are no longer alive.
std::vector<std::filesystem::path> orphans(const std::filesystem::path& scratch);

}  // namespace salbench
