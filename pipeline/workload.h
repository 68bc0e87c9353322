// The items of a run: which meshes, which scans of them, and what their files contain.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cache/digest.h"
#include "io/dataset.h"
#include "pipeline/shard.h"

namespace salbench {

// A file that an item is read from, by the name it has in a key, with its digest or why there is none.
struct SourceDigest {
  std::string name;  // "mesh file .off", "saliency file", "picks 3": no paths
  std::optional<Digest> digest;
  std::string error;
};

struct Family {
  DatasetItem source;  // a mesh, and its scans are its family
  std::vector<SourceDigest> mesh_file;
  std::vector<SourceDigest> truth_files;                  // empty: nothing is known about the mesh
  std::vector<std::vector<SourceDigest>> map_files = {};  // given: of the mesh, then of its scans; or empty
};

struct Workload {
  std::vector<Family> families;  // in the data set's order
  std::vector<std::string> notes;
};

std::vector<std::string> split_list(const std::string& list);  // at commas, without blanks and empty parts

// Reads and digests the files of the items that `selection` names ("1-20,52,125"; empty: all), or of one
// share of them. Throws ConfigError where it names an item that is not there.
Workload make_workload(const Dataset& dataset, const std::string& selection,
                       const std::optional<Shard>& shard = {});

}  // namespace salbench
