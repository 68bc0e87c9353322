// SPDX-License-Identifier: GPL-3.0-or-later
// Agreement of detected interest points with those that people marked. [dutagaci2012]
#pragma once

#include <cstdint>
#include <limits>
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

// All NaN without marked points. Without detected ones each has its worst value. A marked point is detected
// correctly if a detected point lies within the tolerance and is not closer to another marked one: each
// detected point counts for the marked point nearest to it, of several at equal distance the first.
struct InterestPointScores {
  double fne = std::numeric_limits<double>::quiet_NaN();  // share of the marked points not detected correctly
  double fpe = fne;  // 1 - (marked points detected correctly) / (detected points)
  double wme = fne;  // as fne, a marked point as often as it was marked
};

// `marked` ascends, and has a point as often as it was marked; `detected` ascends. Distances are shortest
// paths along edges; the tolerance is a fraction of the shape's diameter.
InterestPointScores interest_point_scores(std::span<const std::int32_t> detected,
                                          std::span<const std::int32_t> marked, const SurfaceGraph& graph,
                                          double tolerance);

}  // namespace salbench
