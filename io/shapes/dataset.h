// SPDX-License-Identifier: GPL-3.0-or-later
// The meshes and point clouds of a data set with the ground truth that belongs to each. What is listed here
// needs no importer: the layout of the Schelling study, any folder of shapes, and sets in the one form.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace salbench {

// Facts of an item that are known before any of its files is read.
struct KnownItem {
  bool is_cloud = false;
  bool has_truth = false;
  std::size_t participants = 0, viewers = 0;  // files of picks, and of saliency by viewer
  std::size_t recorded = 0;                   // people whose gaze on it was recorded
};

// A file of an imported item.
struct SourceFile {
  std::string name;  // in keys: says how it is read, and has no path in it
  std::string path;
  std::string title;  // for messages: "mesh file cow.obj"
};

// An item that is read whole, with its ground truth: a file in the one form, or files that the Python package
// makes one of.
struct ImportedItem {
  KnownItem known;
  std::vector<SourceFile> files;  // in the order in which they are read; that of the shape first
  bool in_form = false;           // the only file is in the one form
};

// Places of files are text: std::filesystem::path takes some 350 bytes for each.
struct DatasetItem {
  std::string name;           // the mesh file's name without its extension; of a view that is scored with
                              // "_VIEW" behind it
  std::string category = {};  // its class; empty if it has none
  std::string mesh;           // .off .obj .ply; of a point cloud .ply .pcd .xyz; else any file of the shape
  std::string saliency = {};  // a value per point; empty if there is none
  std::vector<std::string> picks = {};  // by participant's number; may be empty
  std::string shape = {};               // of a view that is scored: the mesh file's name; else empty
  std::string view = {};                // that is scored
  std::string split = {};               // empty if it is in none; "train+test" if it is in both
  std::shared_ptr<const ImportedItem> imported = {};  // then saliency and picks are empty
  std::string problem = {};                           // why its ground truth cannot be used: one line

  const std::string& shape_name() const { return shape.empty() ? name : shape; }
  bool has_truth() const;  // or should have it; a recording of gaze, too, becomes some
  bool is_recorded() const { return imported && imported->known.recorded > 0; }
  bool is_in_form() const { return imported && imported->in_form; }
};

// A name in a split that is no item.
struct SplitEntry {
  std::string split, item;
  std::string where;  // "splits.csv:7"
};

// Who reads the items of a data set, in place of this program.
struct DataImporter {
  std::string layout = {}, root = {};  // as the items were listed
  std::int32_t version = 0;            // 0: there is none
};

struct Dataset {
  std::string layout;              // name of the layout found
  std::vector<DatasetItem> items;  // in natural order: 2 before 10
  std::vector<std::string> notes;  // one line each: ground truth without a shape, numbers that are missing
  std::string splits_where = {};   // of the description, or the index
  std::string no_splits = {};      // why no item is in a split; empty: some are, or none are described
  std::vector<SplitEntry> unknown = {};
  std::string remark = {};  // on the ground truth, repeated in every table; empty: none
  DataImporter importer = {};
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
