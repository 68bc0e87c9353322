// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of one artefact, and of every artefact in a cache folder.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cache/artefact_name.h"
#include "cache/key.h"
#include "io/hdf5/hdf5_file.h"
#include "stages/core/progress.h"

namespace salbench {

// Recipe of an artefact, from its own attributes; nothing if one is missing or malformed.
std::optional<Recipe> recipe_from(const Attributes& attributes);

// Describes how the bytes differ from those that were written under this name; empty if they are the same.
std::string damage(std::span<const std::byte> bytes, const ArtefactName& name);

struct Inspection {
  std::optional<Hdf5Content> content;  // of a sound artefact
  std::string fault;                   // of any other artefact: "checksum mismatch"
};

// Checks the bytes of the file `name` of `stage`: complete, checksum, content as in the name, and attributes
// that give the key in the name.
Inspection inspect_artefact(std::span<const std::byte> bytes, std::string_view stage,
                            const ArtefactName& name);

struct Fault {
  std::filesystem::path file;
  std::string what;
};

struct Verification {
  std::size_t artefacts = 0;  // checked, sound or not
  std::uint64_t bytes = 0;    // total size of these
  std::size_t others = 0;     // files that are not artefacts, not checked
  std::vector<Fault> faults;  // by file
};

// Reads every artefact and changes nothing; skips files that another process removes in the meantime. Ends
// early once `stop` is set. Throws StorageError if the folder is not a cache or cannot be listed.
Verification verify_cache(const std::filesystem::path& folder, const std::atomic<bool>& stop,
                          Progress& progress);

}  // namespace salbench
