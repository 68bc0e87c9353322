// SPDX-License-Identifier: GPL-3.0-or-later
// Finds the meshes and point clouds of a data set and the ground truth that belongs to each, in the layouts
// that descriptions give (configs/datasets/*.yaml; pipeline/config/data_layout.h reads them).
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/cameras.h"
#include "io/file_pattern.h"
#include "io/splits.h"
#include "io/truth_format.h"
#include "io/twins.h"
#include "stages/core/options.h"

namespace salbench {

struct TruthPlace {
  FilePattern saliency;   // values; one file per item, or one per view or viewer
  FilePattern picks;      // one file per participant, or one per item
  FilePattern mask = {};  // 0 for hidden, 1 for seen; one file per file of saliency, or one per item
  Cameras cameras = {};   // what they do not see is hidden, too
};

// Views of a shape are averaged into one ground truth, or each is scored as a unit of its own.
enum class Views { averaged, scored };
template <>
struct EnumNames<Views> {
  static constexpr std::array<std::string_view, 2> names = {"averaged", "scored"};
};

struct Place {
  std::string needs;              // folder without which the place is not looked at; empty: none
  std::string root_is;            // the name that the root itself must have; empty: any
  FilePattern meshes;             // the name without extension is the item's
  std::vector<TruthPlace> truth;  // the first that has an existing folder is taken
  Views views = Views::averaged;
};

// Category of an item: none, the name of its mesh's folder, or the class in SHREC'07 of a mesh named 1 to
// 400. [giorgi2007]
enum class Classes { none, folder, shrec07 };
template <>
struct EnumNames<Classes> {
  static constexpr std::array<std::string_view, 3> names = {"none", "folder", "shrec07"};
};

// Which of the files that fit a place's pattern are shapes, by their extension. A .ply file may be either.
enum class Domain { any, meshes, points };
template <>
struct EnumNames<Domain> {
  static constexpr std::array<std::string_view, 3> names = {"any", "meshes", "points"};
};

// Unit of length of the shapes' files.
struct LengthUnit {
  std::string where = {};  // of the description; empty: it names none
  double scale = 1;        // of the files' coordinates, where lengths are shown
};

struct Layout {
  std::string name;
  std::vector<Place> places;  // below the folder that the user names; the first with a mesh is taken
  Classes classes = Classes::none;
  Domain domain = Domain::any;
  bool needs_truth = true;  // patterns of ground truth that fit no file are an error
  TruthFormat format = {};
  DataSplits splits = {};
  LengthUnit unit = {};
  std::string index = {};    // file below the folder that lists items in the one form; no places then
  std::string licence = {};  // on what terms the authors give the data, as far as is known
};

struct MaskFile {
  std::string path;          // where it is, or where it should be
  std::string missing = {};  // what to do about it, if it is not there
};

// Entry of an item in the index of a set in the one form (io/one_form_index.h).
struct IndexedItem {
  bool is_cloud = false;
  bool has_truth = false;
  std::size_t participants = 0, viewers = 0;  // files of picks, and of saliency by viewer
};

// Places of files are text: std::filesystem::path takes some 350 bytes for each.
struct DatasetItem {
  std::string name;                                // the mesh file's name without its extension; of a
                                                   // view that is scored with "_VIEW" behind it
  std::string category;                            // its class; empty if it has none
  std::string mesh;                                // .off .obj .ply; of a point cloud .ply .pcd .xyz
  std::vector<std::string> saliency;               // one, or one per view or viewer; empty if there is none
  std::vector<std::string> picks;                  // by participant's number; may be empty
  bool by_viewer = false;                          // the saliency files are of one viewer each
  std::shared_ptr<const TruthFormat> format = {};  // how these are read; null: as TruthFormat's defaults are
  std::vector<std::string> views = {};             // of each saliency file: its view or viewer
  std::vector<MaskFile> masks = {};                // one per saliency file; none: all was seen
  std::vector<ItemCamera> cameras = {};            // likewise; one if there is no saliency file
  std::string shape = {};                   // of a view that is scored: the mesh file's name; else empty
  std::string view = {};                    // that is scored
  std::string split = {};                   // empty if it is in none
  std::optional<IndexedItem> indexed = {};  // `mesh` is a file in the one form, with everything in it
  std::string problem = {};                 // why its ground truth cannot be used: one line

  const std::string& shape_name() const { return shape.empty() ? name : shape; }
};

struct Dataset {
  std::string layout;              // name of the layout found
  std::vector<DatasetItem> items;  // in natural order: 2 before 10
  std::vector<std::string> notes;  // one line each: ground truth without a shape, numbers that are missing
  std::vector<std::string> read = {};    // files beside those of items: that of the splits
  std::string splits_where = {};         // of the description
  std::string no_splits = {};            // why no item is in a split; empty: some are, or none are described
  std::vector<SplitEntry> unknown = {};  // names in splits that are no items
  LengthUnit unit = {};
  std::string licence = {};  // of the description
};

// Takes the first layout that fits. Lists folders and reads no file but that of the splits; the result does
// not depend on the order in which the system lists them. Throws InputError if there are no shapes, naming
// what was looked for, if several files have the same name and `twins` does not tell which of them counts, if
// an item has two files where one is meant, or if needed ground truth is missing.
Dataset find_dataset(const std::filesystem::path& root, std::span<const Layout> layouts,
                     Twins twins = Twins::refuse);

}  // namespace salbench
