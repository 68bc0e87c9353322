// The items of a run: which meshes, which scans of them, and what their files contain.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/dataset.h"
#include "pipeline/shard.h"
#include "pipeline/source.h"

namespace salbench {

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

}  // namespace salbench
