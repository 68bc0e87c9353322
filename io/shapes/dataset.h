// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes and point clouds of a data set with their ground truth. Lists the layout of the Schelling study, any
// folder of shapes, and sets in the HDF5 form.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "io/hdf5/one_form.h"

namespace salbench {

// Reader of an item's files.
enum class ReadBy {
  salbench,  // a mesh or point cloud, a file of values per point, files of picks
  form,      // a file in the HDF5 form, including ground truth
  front      // any files, by the data set's Python function
};

// A scored unit: a shape or one view of it, as known before any file is read. Paths are strings, since a
// std::filesystem::path takes some 350 bytes.
struct Item {
  std::string name;           // name of the shape; "SHAPE_VIEW" for a separately scored view
  std::string category = {};  // class; may be empty
  std::string split = {};     // empty if in none; "train+test" if in both
  std::string shape = {};     // separately scored view: name of its shape; else empty
  std::string view = {};      // separately scored view
  std::string problem = {};   // reason why its ground truth is unusable, one line
  ReadBy read_by = ReadBy::salbench;
  std::string file;                     // file of the shape
  std::string saliency = {};            // read by salbench: one value per point; may be empty
  std::vector<std::string> picks = {};  // read by salbench, in the order of the participants; may be empty
  std::vector<std::string> files = {};  // read by the front: all files, that of the shape first
  std::string key = {};                 // read by the front: what determines the result besides file contents
  // Set by the listing for items of the front; determined by salbench for others.
  bool is_cloud = false;
  bool with_truth = false;
  std::size_t participants = 0, viewers = 0;  // people with picks, and people with their own map
  std::size_t recorded = 0;                   // people with recorded gaze

  const std::string& shape_name() const { return shape.empty() ? name : shape; }
  bool has_truth() const;  // expected to have ground truth; a gaze recording also yields some
  bool is_recorded() const { return recorded > 0; }
  bool is_in_form() const { return read_by == ReadBy::form; }
};

// Name in a split that is not an item.
struct SplitEntry {
  std::string split, item;
  std::string where;  // "splits.csv:7"
};

// Reads the shape of an item with its ground truth.
using ReadItem = std::function<ShapeInForm(const Item&)>;

struct Dataset {
  std::string layout;              // detected layout
  std::vector<Item> items;         // in natural order: 2 before 10
  std::vector<std::string> notes;  // one line each: ground truth without a shape, missing numbers
  std::string splits_where = {};   // file with the splits
  std::string no_splits = {};      // reason why no item is in a split; empty if some are or none are known
  std::vector<SplitEntry> unknown = {};
  std::string remark = {};  // remark on the ground truth, repeated in every table; may be empty
  // Reader of a data set that the front reads, with its version; empty and 0 for others.
  ReadItem read = {};
  std::int32_t version = 0;
};

inline constexpr std::string_view kAutomaticLayout = "automatic";  // the first that matches

// Layouts listed by this file.
inline constexpr std::string_view kSchelling = "schelling", kFolder = "folder", kOneForm = "hdf5";

// Normalised: "data/" becomes "data".
std::filesystem::path data_folder(const std::filesystem::path& root);

// True if there are shapes where one of these three layouts expects them.
bool fits_layout(const std::filesystem::path& root, std::string_view layout);

// True if the folder contains a shape file.
bool has_shapes(const std::filesystem::path& folder);

// Places where a layout's shapes are searched: "/data/Meshes, /data/SchellingData/Meshes".
std::string places_of(const std::filesystem::path& root, std::string_view layout);

// Lists folders and reads no file except an index; the result is independent of the system's listing order;
// extensions may be in either case. Throws InputError if there are no shapes, or if files share a name.
Dataset native_dataset(const std::filesystem::path& root, std::string_view layout);

}  // namespace salbench
