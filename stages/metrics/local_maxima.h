// SPDX-License-Identifier: GPL-3.0-or-later
// Interest points of a map: its local maxima on a surface.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stages/metrics/surface_graph.h"

namespace salbench {

struct LocalMaximaOptions {
  double radius = 0;  // of the neighbourhood, along edges, in R; 0: the points next to it
  double height = 1;  // least height, in multiples of the mean height of all local maxima
};

// Ascending. Connected points of one value, a plateau, are one local maximum, the first of them, if no point
// next to them is higher and some point is lower; within the radius none may be higher, and none of equal
// height come before it. The map is min-max-normalised, which heights are measured in; a constant one has no
// local maxima.
std::vector<std::int32_t> local_maxima(std::span<const double> map, const SurfaceGraph& graph,
                                       const LocalMaximaOptions& options);

}  // namespace salbench
