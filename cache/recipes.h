// SPDX-License-Identifier: GPL-3.0-or-later
// Lists the artefacts of a cache with their recipes, without reading arrays. Read-only.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cache/artefact.h"

namespace salbench {

// Artefact as listed in the cache's files.
struct KnownArtefact {
  std::filesystem::path file;
  std::string stage, label;  // label of the item
  Digest key, content;
  std::optional<Recipe> recipe = {};  // if requested
};

// All artefacts of an item and stage, with any key, except those with a damaged record.
std::vector<KnownArtefact> known_recipes(const std::filesystem::path& folder, std::string_view family,
                                         std::string_view stage, std::string_view item);

// Without recipes; empty if the head is damaged.
std::vector<KnownArtefact> artefacts_in(const std::filesystem::path& file);

// Complete artefact; nullopt if it is gone. Throws InputError if it is damaged.
std::optional<Artefact> read_artefact(const KnownArtefact& known);

}  // namespace salbench
