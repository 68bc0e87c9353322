// SPDX-License-Identifier: GPL-3.0-or-later
// Mesh simplification by collapsing edges in the order of quadric error.
#pragma once

#include <cstddef>

#include "stages/core/types.h"

namespace salbench {

// Collapses edges until the mesh has at most `target_faces` faces, or until every further collapse would
// change the topology or invert a face. Each new vertex is placed at the least quadric error. Duplicate
// faces, degenerate faces and unreferenced vertices are removed; connected points stay connected. Accepts any
// triangle soup: open, non-manifold, with several components, and with inconsistent orientation. Indices must
// be valid and coordinates finite. [garland1997]
Mesh simplified(const Mesh& mesh, std::size_t target_faces);

}  // namespace salbench
