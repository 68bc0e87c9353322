// SPDX-License-Identifier: GPL-3.0-or-later
// Uniform Laplacian smoothing of maps: a map may agree with people better than its noise lets it.
#pragma once

#include <cstdint>

#include "stages/core/types.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {

// n: in each step every point takes the mean over itself and its neighbours along edges, all with the same
// weight. Points without edges stay as they are. `steps` >= 0; so many steps after others are their sum.
ScalarField smoothed_by_steps(ScalarField map, const Adjacency& adjacency, std::int32_t steps);

}  // namespace salbench
