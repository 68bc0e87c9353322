// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the recipes of a folder's artefacts and compares two recipes. Changes nothing.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cache/key.h"
#include "cache/layout.h"

namespace salbench {

// One component in which two recipes differ; a side is empty where it has no such component.
struct RecipeDifference {
  enum class Part { version, option, seed, input, order } part = Part::version;
  std::string name;  // of the option or the input
  std::string before, after;

  bool operator==(const RecipeDifference&) const = default;
};

// Empty if the two give the same key. Assumes that the stages are the same.
std::vector<RecipeDifference> differences(const Recipe& before, const Recipe& after);

struct RecipeReading {
  std::optional<Recipe> recipe;  // of a sound artefact, from its root attributes
  std::string fault;             // of any other artefact: "checksum mismatch"
};
RecipeReading read_recipe(const ArtefactFile& file);

// The artefacts of a folder by stage and item.
class RecipeBook {
 public:
  explicit RecipeBook(std::filesystem::path folder);

  // Truncated and damaged ones included, which no run will use. Names are kept of the stage last asked for.
  std::vector<ArtefactFile> artefacts(const std::string& stage, std::string_view item);

  // Those of a key; looks at no other folder than its own.
  std::vector<ArtefactFile> artefacts(const std::string& stage, const Digest& key) const;

  // A quarantined artefact of this key; nullptr if there is none.
  const std::filesystem::path* quarantined(const Digest& key) const;

 private:
  ArtefactFile located(const std::string& stage, ArtefactName name) const;

  std::filesystem::path folder_;
  std::string stage_;               // last asked for
  std::vector<std::string> files_;  // its names, sorted
  std::map<Digest, std::filesystem::path> quarantined_;
};

}  // namespace salbench
