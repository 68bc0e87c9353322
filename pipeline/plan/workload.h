// SPDX-License-Identifier: GPL-3.0-or-later
// The items of a run: which meshes, which scans of them, which point clouds, and what their files contain.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/dataset.h"
#include "pipeline/catalog/catalog.h"
#include "pipeline/catalog/models.h"
#include "pipeline/catalog/row.h"
#include "pipeline/catalog/source.h"
#include "pipeline/plan/shard.h"
#include "stages/scan/scan.h"

namespace salbench {

// A mesh, one of its scans, a point cloud, or the data set as a whole.
struct Item {
  static constexpr int kMesh = -1, kSet = -2, kCloud = -3;

  std::size_t family = 0;
  int view = kMesh;  // 0..kViews-1 of a scan

  static Item mesh(std::size_t family) { return {family, kMesh}; }
  static Item cloud(std::size_t family) { return {family, kCloud}; }
  static Item set() { return {0, kSet}; }
  bool is_mesh() const { return view == kMesh; }
  bool is_scan() const { return view >= 0; }
  bool is_set() const { return view == kSet; }
  Shapes shapes() const {  // not of a set
    return is_scan() ? Shapes::scans : is_mesh() ? Shapes::meshes : Shapes::clouds;
  }
  Scope scope() const { return is_set() ? Scope::set : scope_of(shapes()); }
  // Place among the items of its scope, where every family has room for a mesh, its scans and a cloud.
  std::size_t index() const {
    return is_set() ? 0 : is_scan() ? family * kViews + static_cast<std::size_t>(view) : family;
  }
  std::size_t in_family() const { return is_scan() ? 1 + static_cast<std::size_t>(view) : 0; }
  bool operator==(const Item&) const = default;
};

// A mesh with its scans, or one point cloud.
struct Family {
  DatasetItem source;
  SourceFiles shape_file;                   // one
  SourceFiles truth_files;                  // empty: nothing is known about the shape
  std::vector<SourceFiles> map_files = {};  // given, [Item::in_family()]; or empty
  bool is_cloud = false;

  Shapes shapes() const { return is_cloud ? Shapes::clouds : Shapes::meshes; }  // besides scans
  Item shape(std::size_t family) const { return is_cloud ? Item::cloud(family) : Item::mesh(family); }
};

struct Workload {
  std::string layout;            // of the data set
  std::vector<Family> families;  // in the data set's order
  std::vector<std::string> notes;
};

// Identity of a run's data, wherever they lie.
struct DataIdentity {
  std::size_t files = 0;  // shapes and ground truth
  Digest digest;          // of the items' names and of all bytes that are read of them
};
DataIdentity identity_of(const Workload& workload);

std::size_t count_clouds(const Workload& workload);
std::string shapes_text(const Workload& workload);  // "3 meshes, 2 point clouds"
DataKinds kinds_of(const Workload& workload);       // what the catalog needs rows for

std::vector<std::string> split_list(const std::string& list);  // at commas, without blanks and empty parts

// Reads and digests the files of the items that `selection` names ("1-20,52,125"; empty: all), or of one
// share of them. Throws ConfigError where it names an item that is not there.
Workload make_workload(const Dataset& dataset, const std::string& selection,
                       const std::optional<Shard>& shard = {});

// Makes the given maps of a model sources of the families. Where no shape of a kind has a map, none is
// expected of any; otherwise a missing one is its item's failure. Throws ConfigError if no item has one.
void add_given_maps(Workload& workload, const Catalog& catalog, const Model& model);

}  // namespace salbench
