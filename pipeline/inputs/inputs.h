// SPDX-License-Identifier: GPL-3.0-or-later
// This folder: what a run reads, data sets with their ground truth and a given reference. Folders and files
// come in; units with their files go out, and functions that read them. It includes the engine, config/, io/
// and stages/, and knows no rule.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "io/shapes/dataset.h"
#include "pipeline/engine/file.h"
#include "pipeline/engine/level.h"
#include "pipeline/inputs/shard.h"

namespace salbench {

// The levels: a data set has meshes, of which each has kViews scans, and point clouds.
inline constexpr Level kMeshes = 1, kScans = 2, kClouds = 3;
inline constexpr std::array kShapeLevels = {kMeshes, kScans, kClouds};
constexpr std::string_view shapes_name(Level level) {
  return std::array<std::string_view, 3>{"meshes", "scans", "clouds"}.at(level - 1U);
}
const std::vector<LevelInfo>& levels();

// How much of a data set has recordings of gaze; of all its items, not only those selected.
enum class Recordings { none, some, alone };  // alone: no item has other ground truth

struct Inputs {
  std::string layout = {};               // of the data set
  std::vector<std::string> notes = {};   // on the data set, for the user
  std::vector<std::string> errors = {};  // likewise, of what should be there and is not: the others go on
  Units units = {};                      // a family is a mesh with its scans, or a point cloud
  FilesOfUnits shape_files = {};  // [family]: one each; of a data set that the front reads, all of them
  FilesOfUnits truth_files = {};  // [family]: none where nothing is known about the shape
  ReadItem read = {};             // of a data set that the front reads, and its version above 0
  std::int32_t version = 0;
  std::optional<Shard> shard = {};  // the units are this share of the data set
  std::string remark = {};          // on the ground truth, repeated in every table; empty: none
  std::string splits = {};          // digest of which item is in which split; empty: none is in one
  Recordings recordings = Recordings::none;
  std::set<std::string> split_names = {};  // of the data set, items that are not chosen included

  // True if there are shapes of this level; a data set that is not known yet has meshes and scans.
  bool has(Level level) const;
  bool has_others() const;  // families that are not chosen
  std::size_t count(Level level) const { return units.of(level).size(); }
  std::string text() const;  // "3 meshes, 2 point clouds"
};

const Item& item_of(const std::any& source);  // the source of a family

File nothing_to_read(std::string name, std::string place);                // a file without content
File failing_file(std::string name, std::string place, std::string why);  // reading it is an InputError

// True of a point cloud: `bytes` may be the beginning of the file's, and are looked at of .ply alone.
bool holds_cloud(const Item& item, std::string_view bytes);

inline const Item& item_of(const Units& units, Unit unit) { return item_of(units.source_of(unit).source); }

inline constexpr std::string_view kScoredItems = "scored";  // those with ground truth

// Items as a user names them: a text such as "1-20,52,125" or kScoredItems (empty: all), or a list of names,
// which may hold commas and blanks. In a text an item of that name is "./scored".
struct ItemChoice {
  ItemChoice() = default;
  ItemChoice(const std::string& list);  // NOLINT(google-explicit-constructor): most are texts
  ItemChoice(const char* list) : ItemChoice(std::string(list)) {}  // NOLINT(google-explicit-constructor)
  explicit ItemChoice(std::vector<std::string> names);

  bool all() const { return text.empty(); }
  bool is_scored() const { return text == kScoredItems && !are_names; }

  std::string text = {};                // for messages
  std::vector<std::string> parts = {};  // names and ranges
  bool are_names = false;               // and nothing else
};

bool is_in_split(std::string_view text, std::string_view split);  // of an item that may be in several

// Keeps the items chosen, of one split if that is named. A view that is scored by itself is named like its
// shape, too. Throws ConfigError for an item or a split that is not there.
void select_items(Dataset& dataset, const ItemChoice& choice, const std::string& split = {});

// What is done with items that are not selected.
enum class Others {
  left_out,
  measured,  // those with ground truth stay as families that are not chosen, for what all items make together
  simulated,  // the same of all of them: their ground truth is made up
};

// The selected items, or one share of them, which has no others. Reads no file but those whose name does not
// say which kind of shape they hold. Throws ConfigError as above.
Inputs read_inputs(Dataset dataset, const ItemChoice& choice = {}, const std::optional<Shard>& shard = {},
                   const std::string& split = {}, Others others = Others::left_out);

// Identity of a run's data, wherever they lie.
struct DataIdentity {
  std::size_t files = 0;  // shapes and ground truth
  Digest digest;          // of the items' names and of all bytes that are read of them
};
DataIdentity identity_of(const Inputs& inputs);

std::vector<std::string> split_list(const std::string& list);  // at commas, without blanks and empty parts

}  // namespace salbench
