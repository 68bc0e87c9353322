// SPDX-License-Identifier: GPL-3.0-or-later
// The edges of a surface, and distances along them.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "stages/core/types.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {

struct SurfaceGraph {
  std::vector<Vec3> points;  // n x 3
  Adjacency edges;
  // Of the whole shape, in its unit: R, and the largest distance of two points.
  double radius = 0, diameter = 0;

  // The graph between some of the points, ascending: no path leads through the others.
  SurfaceGraph at(std::span<const std::int32_t> some) const;
};

// Throws InputError for a face whose point does not exist.
SurfaceGraph surface_graph(Points points, Surface surface);

// The largest distance of two points, exactly; 0 of none.
double diameter_of(Points points);

// Which of some points is nearest along the edges; of those at equal distance, the first in the list.
struct NearestSource {
  std::int32_t source = -1;  // place in the list; -1: none within reach
  double distance = std::numeric_limits<double>::infinity();
};
// n, for all points at once: one search from all sources together, which ends at distance > reach.
std::vector<NearestSource> nearest_sources(const SurfaceGraph& graph, std::span<const std::int32_t> sources,
                                           double reach);

}  // namespace salbench
