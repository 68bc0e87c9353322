// SPDX-License-Identifier: GPL-3.0-or-later
// The recipes that a cache has, read without its arrays, and how two of them differ. Changes nothing.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>
#include <vector>

#include "cache/artefact.h"

namespace salbench {

// One component in which two recipes differ; a side is empty where it has no such component.
struct RecipeDifference {
  enum class Part { version, option, seed, input, order, part } part = Part::version;
  std::string name;  // of the option or the input
  std::string before, after;

  bool operator==(const RecipeDifference&) const = default;
};

// Empty if the two give the same key. Assumes that the stages are the same.
std::vector<RecipeDifference> differences(const Recipe& before, const Recipe& after);

// Compares lines `name: value`, as options have them. The order does not count.
std::vector<RecipeDifference> differences_of_parts(const std::string& before, const std::string& after);

// An artefact as the cache's files name it.
struct KnownArtefact {
  std::filesystem::path file;
  std::string stage, label;  // of the item
  Digest key, content;
  std::optional<Recipe> recipe = {};  // nothing: its record is damaged
  std::string parts = {};             // its attribute of this name
};

// Reads the heads of a family's files when it is first asked for. They may change meanwhile.
class RecipeBook {
 public:
  explicit RecipeBook(std::filesystem::path folder) : folder_(std::move(folder)) {}

  // All artefacts of an item that are of the stage, whatever their keys, or have the key, whatever their
  // stage.
  std::vector<KnownArtefact> find(std::string_view family, std::string_view stage, std::string_view item,
                                  const Digest& key = {});
  bool has_read(std::string_view family) const { return families_.contains(item_label(family)); }
  std::size_t read() const { return read_; }  // artefacts so far

 private:
  std::vector<KnownArtefact> read_family(const std::string& label);

  std::filesystem::path folder_;
  std::map<std::string, std::vector<KnownArtefact>> families_;  // by label
  std::size_t read_ = 0;
};

// Keys of older versions, and of all that was made of them. Versions are artefacts of one stage, whose name
// begins with `stages`, and of one item, with one seed and the same inputs but for those named: their
// options, or what is named, differ. The newest is in the file that was written last; versions in one file
// are equally new.
std::unordered_set<Digest> older_versions(const std::filesystem::path& folder, std::string_view stages,
                                          std::string_view but_for);

// Without their recipes; a file whose head is damaged has none.
std::vector<KnownArtefact> artefacts_in(const std::filesystem::path& file);

// Whole. Nothing: it is gone. Throws InputError where it is damaged.
std::optional<Artefact> read_artefact(const KnownArtefact& known);
std::string fault_of(const KnownArtefact& known);  // "checksum mismatch"; empty: it is sound, or gone

}  // namespace salbench
