// Mesh simplification by collapsing edges in the order of their quadric error.
#pragma once

#include <cstddef>

#include "stages/core/types.h"

namespace salbench {

// The mesh with at most `target_faces` faces, or as few as collapses can leave that neither change the
// topology nor fold a face over; each collapse puts the new vertex where its quadric error is least.
// Duplicate faces, degenerate ones and unreferenced vertices are gone. Takes any soup of triangles: open,
// non-manifold, of several components, and of inconsistent orientation; connected points stay connected.
// Indices valid, coordinates finite. [garland1997]
Mesh simplified(const Mesh& mesh, std::size_t target_faces);

}  // namespace salbench
