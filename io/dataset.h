// SPDX-License-Identifier: GPL-3.0-or-later
// Finds the meshes and point clouds of a data set and the ground truth that belongs to each, in the folder
// layouts in use.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/twins.h"
#include "stages/core/options.h"

namespace salbench {

// Layouts: the paths of the files of mesh N below ROOT, the folder that the user names.
//   gs         GS/{Saliency/N.val, RawData/N_k.pid} with meshes in off/ or Meshes/; or ROOT is GS/
//   schelling  {Meshes/N.off, Distributions/N.val, RawData/N_k.pid}, also below SchellingData/, once or twice
//              [chen2012]
//   princeton  off/N.off in ROOT, data/ or MeshsegBenchmark-1.0/data/; ground truth as in the layouts above
//              [chen2009]
//   folder     the meshes in ROOT itself; Distributions/ and RawData/ in it or beside it, or nowhere
//   automatic  the first of these that fits
enum class Layout { automatic, schelling, princeton, gs, folder };
template <>
struct EnumNames<Layout> {
  static constexpr std::array<std::string_view, 5> names = {"automatic", "schelling", "princeton", "gs",
                                                            "folder"};
};

struct TruthFolders {
  std::filesystem::path saliency;  // N.val
  std::filesystem::path picks;     // N_k.pid
};

struct Place {
  std::filesystem::path meshes;
  std::vector<TruthFolders> truth;  // the first that has an existing folder is taken
};

// The table of layouts, in the order in which `automatic` tries them.
struct LayoutRow {
  std::string_view name;
  std::vector<Place> (*places)(const std::filesystem::path& root);  // the first with a mesh is taken
  bool is_benchmark = false;  // meshes named 1 to 400 are those of SHREC'07, and have its classes
};
std::span<const LayoutRow> layout_rows();

struct DatasetItem {
  std::string name;                          // the mesh file's name without its extension
  std::string category;                      // class of SHREC'07; empty if it has none
  std::filesystem::path mesh;                // .off .obj .ply; of a point cloud .ply .pcd .xyz
  std::filesystem::path saliency;            // .val; empty if there is none
  std::vector<std::filesystem::path> picks;  // .pid by participant's number; may be empty
};

struct Dataset {
  std::string layout;              // name of the layout found
  std::vector<DatasetItem> items;  // in natural order: 2 before 10
  std::vector<std::string> notes;  // one line each: ground truth without a mesh, numbers that are missing
};

// Lists folders and reads no file; the result does not depend on the order in which the system lists them.
// Throws InputError if there are no shapes, naming the folders searched, or if several files have the same
// name and `twins` does not tell which of them counts.
Dataset find_dataset(const std::filesystem::path& root, Layout layout, Twins twins = Twins::refuse);
Dataset find_dataset(const std::filesystem::path& root, std::span<const LayoutRow> layouts,
                     Twins twins = Twins::refuse);

// A strict total order that compares runs of digits as numbers: "2" < "10", "1_2" < "1_10".
bool natural_less(std::string_view a, std::string_view b);

}  // namespace salbench
