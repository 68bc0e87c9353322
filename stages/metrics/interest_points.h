// SPDX-License-Identifier: GPL-3.0-or-later
// Agreement of detected interest points with those marked by people. [dutagaci2012]
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "stages/metrics/surface_graph.h"

namespace salbench {

struct LocalMaximaOptions {
  double radius = 0;  // neighbourhood along edges, in R; 0: adjacent points
  double height = 1;  // least height, relative to the mean height of all local maxima
};

// Ascending. A plateau of connected points with one value is a local maximum, represented by its first point,
// if no adjacent point is higher and some are lower; within the radius none may be higher, or equal and
// earlier. The map is min-max-normalised, which defines heights; a constant one has no local maxima.
std::vector<std::int32_t> local_maxima(std::span<const double> map, const SurfaceGraph& graph,
                                       const LocalMaximaOptions& options);

// All NaN without marked points. Without detected ones each has its worst value. A marked point is detected
// correctly if a detected point lies within the tolerance and is not closer to another marked one: each
// detected point counts for its nearest marked point, among equally distant ones the first.
struct InterestPointScores {
  double fne = std::numeric_limits<double>::quiet_NaN();  // share of the marked points not detected correctly
  double fpe = fne;  // 1 - (marked points detected correctly) / (detected points)
  double wme = fne;  // as fne, counting a marked point as often as it was marked
};

// `marked` ascends, with multiplicity; `detected` ascends. Distances are shortest paths along edges; the
// tolerance is a fraction of the shape's diameter.
InterestPointScores interest_point_scores(std::span<const std::int32_t> detected,
                                          std::span<const std::int32_t> marked, const SurfaceGraph& graph,
                                          double tolerance);

}  // namespace salbench
