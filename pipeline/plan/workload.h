// SPDX-License-Identifier: GPL-3.0-or-later
// The items of a run: which meshes, which scans of them, and what their files contain.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/dataset.h"
#include "pipeline/catalog/models.h"
#include "pipeline/catalog/row.h"
#include "pipeline/catalog/source.h"
#include "pipeline/plan/shard.h"
#include "stages/scan/scan.h"

namespace salbench {

// A mesh, one of its scans, or the data set as a whole.
struct Item {
  static constexpr int kMesh = -1, kSet = -2;

  std::size_t family = 0;
  int view = kMesh;  // 0..kViews-1 of a scan

  static Item mesh(std::size_t family) { return {family, kMesh}; }
  static Item set() { return {0, kSet}; }
  bool is_mesh() const { return view == kMesh; }
  bool is_set() const { return view == kSet; }
  Scope scope() const { return is_set() ? Scope::set : is_mesh() ? Scope::mesh : Scope::scan; }
  std::size_t index() const {  // among the items of its scope
    return is_set() ? 0 : is_mesh() ? family : family * kViews + static_cast<std::size_t>(view);
  }
  bool operator==(const Item&) const = default;
};

struct Family {
  DatasetItem source;                       // a mesh, and its scans are its family
  SourceFiles mesh_file;                    // one
  SourceFiles truth_files;                  // empty: nothing is known about the mesh
  std::vector<SourceFiles> map_files = {};  // given: of the mesh, then of its scans; or empty
};

struct Workload {
  std::string layout;            // of the data set
  std::vector<Family> families;  // in the data set's order
  std::vector<std::string> notes;
};

// Identity of a run's data, wherever they lie.
struct DataIdentity {
  std::size_t files = 0;  // meshes and ground truth
  Digest digest;          // of the items' names and of all bytes that are read of them
};
DataIdentity identity_of(const Workload& workload);

std::vector<std::string> split_list(const std::string& list);  // at commas, without blanks and empty parts

// Reads and digests the files of the items that `selection` names ("1-20,52,125"; empty: all), or of one
// share of them. Throws ConfigError where it names an item that is not there.
Workload make_workload(const Dataset& dataset, const std::string& selection,
                       const std::optional<Shard>& shard = {});

// Makes the given maps of a model sources of the families. Where no mesh, or no scan, has a map, none is
// expected of any; otherwise a missing one is its item's failure. Throws ConfigError if no item has one.
void add_given_maps(Workload& workload, const Catalog& catalog, const Model& model);

}  // namespace salbench
