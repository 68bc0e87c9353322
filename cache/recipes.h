// SPDX-License-Identifier: GPL-3.0-or-later
// The artefacts that a cache has, and their recipes, read without their arrays. Changes nothing.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cache/artefact.h"

namespace salbench {

// An artefact as the cache's files name it.
struct KnownArtefact {
  std::filesystem::path file;
  std::string stage, label;  // of the item
  Digest key, content;
  std::optional<Recipe> recipe = {};  // where it was asked for
};

// All artefacts of an item that are of the stage, whatever their keys; without those whose record is damaged.
std::vector<KnownArtefact> known_recipes(const std::filesystem::path& folder, std::string_view family,
                                         std::string_view stage, std::string_view item);

// Without their recipes; a file whose head is damaged has none.
std::vector<KnownArtefact> artefacts_in(const std::filesystem::path& file);

// Whole. Nothing: it is gone. Throws InputError where it is damaged.
std::optional<Artefact> read_artefact(const KnownArtefact& known);

}  // namespace salbench
