// Reads back what the artefacts of a cache folder were made from, and tells two recipes apart. Changes
// nothing.
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

// Empty where the two give the same key. Stages are taken to be the same.
std::vector<RecipeDifference> differences(const Recipe& before, const Recipe& after);

struct RecipeReading {
  std::optional<Recipe> recipe;  // of a sound artefact, from its root attributes
  std::string fault;             // of any other: "checksum mismatch"
};
RecipeReading read_recipe(const ArtefactFile& file);

// The artefacts of a folder by stage and item. A stage is listed when it is first asked for.
class RecipeBook {
 public:
  explicit RecipeBook(std::filesystem::path folder);

  // By path; also those cut short or damaged, which no run will use.
  const std::vector<ArtefactFile>& artefacts(const std::string& stage, std::string_view item);

  // An artefact under this key that a run has moved aside as damaged.
  const std::filesystem::path* quarantined(const Digest& key) const;

 private:
  using ByItem = std::map<std::string, std::vector<ArtefactFile>, std::less<>>;

  std::filesystem::path folder_;
  std::map<std::string, ByItem> stages_;
  std::map<Digest, std::filesystem::path> quarantined_;
};

}  // namespace salbench
