// SPDX-License-Identifier: GPL-3.0-or-later
// This folder: the inputs of a run, that is data sets with their ground truth, and a given reference. Folders
// and files come in; units with their files, and functions that read them, go out. It includes the engine,
// config/, io/ and stages/, and no rules.
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

// Levels of a data set: meshes, kViews scans per mesh, and point clouds.
inline constexpr Level kMeshes = 1, kScans = 2, kClouds = 3;
inline constexpr std::array kShapeLevels = {kMeshes, kScans, kClouds};
constexpr std::string_view shapes_name(Level level) {
  return std::array<std::string_view, 3>{"meshes", "scans", "clouds"}.at(level - 1U);
}
const std::vector<LevelInfo>& levels();

// Extent of gaze recordings in the data set, over all items, selected or not.
enum class Recordings { none, some, alone };  // alone: every ground truth is a recording

struct Inputs {
  std::string layout = {};               // layout of the data set
  std::vector<std::string> notes = {};   // notes on the data set for the user
  std::vector<std::string> errors = {};  // missing parts of it; other items go on
  Units units = {};                      // a family is a mesh with its scans, or a point cloud
  FilesOfUnits shape_files = {};  // [family]: one each; all of its files if the front reads the data set
  FilesOfUnits truth_files = {};  // [family]: empty without ground truth
  ReadItem read = {};             // set if the front reads the data set; its version is above 0
  std::int32_t version = 0;
  std::optional<Shard> shard = {};  // set if the units are a share of the data set
  std::string remark = {};          // remark on the ground truth, repeated in every table; may be empty
  std::string splits = {};          // digest of the assignment of items to splits; empty without splits
  Recordings recordings = Recordings::none;
  std::set<std::string> split_names = {};  // splits of the data set, including those of items not chosen

  // True if there are shapes of this level; an unknown data set is assumed to have meshes and scans.
  bool has(Level level) const;
  bool has_others() const;  // families that are not chosen
  std::size_t count(Level level) const { return units.of(level).size(); }
  std::string text() const;  // "3 meshes, 2 point clouds", or "6 views of 3 meshes"
};

const Item& item_of(const std::any& source);  // item of a family, from its `source`

File nothing_to_read(std::string name, std::string place);                // file without content
File failing_file(std::string name, std::string place, std::string why);  // reading it throws InputError

// True for a point cloud. `bytes` may be the beginning of the file; they are examined for .ply only.
bool holds_cloud(const Item& item, std::string_view bytes);

inline const Item& item_of(const Units& units, Unit unit) { return item_of(units.source_of(unit).source); }

inline constexpr std::string_view kScoredItems = "scored";  // items with ground truth

// Items as a user names them: a text such as "1-20,52,125" or kScoredItems (empty: all), or a list of names,
// which may contain commas and blanks. In a text, an item named "scored" is written "./scored".
struct ItemChoice {
  ItemChoice() = default;
  ItemChoice(const std::string& list);  // NOLINT(google-explicit-constructor): most are texts
  ItemChoice(const char* list) : ItemChoice(std::string(list)) {}  // NOLINT(google-explicit-constructor)
  explicit ItemChoice(std::vector<std::string> names);

  bool all() const { return text.empty(); }
  bool is_scored() const { return text == kScoredItems && !are_names; }

  std::string text = {};                // the choice in messages
  std::vector<std::string> parts = {};  // names and ranges
  bool are_names = false;               // only names, no ranges or keywords
};

bool is_in_split(std::string_view text, std::string_view split);  // `text`: the splits of an item

// Keeps the chosen items, of one split if `split` is set. A view that is scored separately also answers to
// its shape's name. Throws ConfigError for an unknown item or split.
void select_items(Dataset& dataset, const ItemChoice& choice, const std::string& split = {});

// Treatment of items that are not selected.
enum class Others {
  left_out,
  measured,   // kept, if they have ground truth, as families that are not chosen: for results over all items
  simulated,  // all of them kept in the same way: their ground truth is simulated
};

// The selected items, or one share of them, which excludes others. Reads only files whose name does not tell
// meshes from clouds. Throws ConfigError as above.
Inputs read_inputs(Dataset dataset, const ItemChoice& choice = {}, const std::optional<Shard>& shard = {},
                   const std::string& split = {}, Others others = Others::left_out);

// Identity of a run's data, independent of location.
struct DataIdentity {
  std::size_t files = 0;  // shapes and ground truth
  Digest digest;          // over the items' names and all bytes that are read
};
DataIdentity identity_of(const Inputs& inputs);

std::vector<std::string> split_list(const std::string& list);  // without blanks and empty parts

}  // namespace salbench
