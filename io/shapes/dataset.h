// SPDX-License-Identifier: GPL-3.0-or-later
// The meshes and point clouds of a data set with the ground truth that belongs to each. Listed here are the
// layout of the Schelling study, any folder of shapes, and sets in the HDF5 form.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "io/hdf5/one_form.h"

namespace salbench {

// Who reads the files of an item.
enum class ReadBy {
  salbench,  // a mesh or a point cloud, a file of values per point, files of picked points
  form,      // a file in the HDF5 form, with its ground truth
  front      // any files, by the function of a data set
};

// A unit that is scored: a shape, or one view of it. What is listed of it is known before a file is read.
// Places of files are text: std::filesystem::path takes some 350 bytes for each.
struct Item {
  std::string name;           // of the shape; of a view that is scored with "_VIEW" behind it
  std::string category = {};  // its class; empty if it has none
  std::string split = {};     // empty if it is in none; "train+test" if it is in both
  std::string shape = {};     // of a view that is scored: the name of its shape; else empty
  std::string view = {};      // that is scored
  std::string problem = {};   // why its ground truth cannot be used: one line
  ReadBy read_by = ReadBy::salbench;
  std::string file;                     // of the shape
  std::string saliency = {};            // read by salbench: a value per point; empty if there is none
  std::vector<std::string> picks = {};  // read by salbench, by participant's number; may be empty
  std::vector<std::string> files = {};  // read by the front: all of them, that of the shape first
  std::string key = {};  // read by the front: what is read depends on, beside the files' contents
  // Facts that the listing gives for items of the front; of all others salbench knows them itself.
  bool is_cloud = false;
  bool with_truth = false;
  std::size_t participants = 0, viewers = 0;  // people with picks, and with a map of their own
  std::size_t recorded = 0;                   // people whose gaze was recorded

  const std::string& shape_name() const { return shape.empty() ? name : shape; }
  bool has_truth() const;  // or should have it; a recording of gaze, too, becomes some
  bool is_recorded() const { return recorded > 0; }
  bool is_in_form() const { return read_by == ReadBy::form; }
};

// A name in a split that is no item.
struct SplitEntry {
  std::string split, item;
  std::string where;  // "splits.csv:7"
};

// Reads the shape of an item with its ground truth.
using ReadItem = std::function<ShapeInForm(const Item&)>;

struct Dataset {
  std::string layout;              // name of the layout found
  std::vector<Item> items;         // in natural order: 2 before 10
  std::vector<std::string> notes;  // one line each: ground truth without a shape, numbers that are missing
  std::string splits_where = {};   // the file that names the splits
  std::string no_splits = {};      // why no item is in a split; empty: some are, or none are known
  std::vector<SplitEntry> unknown = {};
  std::string remark = {};  // on the ground truth, repeated in every table; empty: none
  // Reader of a data set that the front reads, and its version; empty and 0 for all others.
  ReadItem read = {};
  std::int32_t version = 0;
};

inline constexpr std::string_view kAutomaticLayout = "automatic";  // the first that fits

// Layouts that are listed here.
inline constexpr std::string_view kSchelling = "schelling", kFolder = "folder", kOneForm = "hdf5";

// "data/" is "data".
std::filesystem::path data_folder(const std::filesystem::path& root);

// True if there are shapes where the layout, one of these three, expects them.
bool fits_layout(const std::filesystem::path& root, std::string_view layout);

// True if there is a shape's file in the folder.
bool has_shapes(const std::filesystem::path& folder);

// "/data/Meshes, /data/SchellingData/Meshes": where the layout's shapes are looked for.
std::string places_of(const std::filesystem::path& root, std::string_view layout);

// Lists folders and reads no file but an index; the result does not depend on the order in which the system
// lists them; extensions may be in upper or lower case. Throws InputError if there are no shapes, or if
// several files have the same name.
Dataset native_dataset(const std::filesystem::path& root, std::string_view layout);

}  // namespace salbench
