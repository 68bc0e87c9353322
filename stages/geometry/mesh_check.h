// SPDX-License-Identifier: GPL-3.0-or-later
// Validation of a mesh before any computation, and counts of its defects.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

struct MeshReport {
  std::int64_t degenerate_faces = 0;   // dropped: a repeated vertex, or no area
  std::int64_t duplicate_faces = 0;    // dropped: the same three vertices as an earlier face, in any order
  std::int64_t isolated_vertices = 0;  // kept: no remaining face uses them
  std::int32_t components = 0;         // connected parts of the surface, without isolated vertices
  // These include faces without area, which connect parts of a surface:
  std::int64_t boundary_edges = 0;     // in one face only
  std::int64_t nonmanifold_edges = 0;  // in three faces or more
  std::int64_t misoriented_edges = 0;  // in two faces that traverse it in the same direction
};

struct CheckedMesh {
  Mesh mesh;  // input vertices in their order, since ground truth is per vertex
  MeshReport report;
};

// Drops unusable faces, and counts harmless defects. A face has no area if its height is within the rounding
// error of its coordinates. Throws InputError for a mesh without a usable face, a face with a vertex index
// out of range, and the cases of wrong_with_extent.
CheckedMesh check_mesh(Mesh mesh);

// One line per kind of defect, except isolated vertices; empty for a clean mesh.
std::vector<std::string> warnings(const MeshReport& report);

}  // namespace salbench
