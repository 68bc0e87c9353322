// SPDX-License-Identifier: GPL-3.0-or-later
// Validation of a mesh before anything is computed from it, and counts of its defects.
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
  std::int32_t components = 0;         // connected parts of the surface; isolated vertices do not count
  // Faces without area count here, since they hold a surface together:
  std::int64_t boundary_edges = 0;     // in one face only
  std::int64_t nonmanifold_edges = 0;  // in three faces or more
  std::int64_t misoriented_edges = 0;  // in two faces that pass it in the same direction
};

struct CheckedMesh {
  Mesh mesh;  // the vertices of the input in their order, since ground truth is per vertex
  MeshReport report;
};

// Drops the faces that cannot be used, and counts the defects that do no harm. A face has no area if its
// height is within the rounding of its coordinates. Throws InputError for a mesh without a usable face, a
// face with a vertex index out of range, and for what wrong_with_extent names.
CheckedMesh check_mesh(Mesh mesh);

// One line per kind of defect, but for isolated vertices; empty for a clean mesh.
std::vector<std::string> warnings(const MeshReport& report);

}  // namespace salbench
