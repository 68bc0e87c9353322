// SPDX-License-Identifier: GPL-3.0-or-later
// Uniform Laplacian smoothing of maps: noise in a map may hide part of its agreement with people.
#pragma once

#include <cstdint>

#include "stages/core/types.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {

// n: each step replaces the value of a point by the mean over itself and its neighbours along edges, equally
// weighted. Points without edges are unchanged. `steps` >= 0; a, then b steps equal a + b.
ScalarField smoothed_by_steps(ScalarField map, const Adjacency& adjacency, std::int32_t steps);

}  // namespace salbench
