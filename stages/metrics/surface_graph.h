// SPDX-License-Identifier: GPL-3.0-or-later
// Edges of a surface, and distances along them.
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
  // R and the largest distance of two points, of the whole shape, in its unit.
  double radius = 0, diameter = 0;

  // Subgraph of some points, ascending: no path passes through the others.
  SurfaceGraph at(std::span<const std::int32_t> some) const;
};

// Throws InputError for a face whose point does not exist.
SurfaceGraph surface_graph(Points points, Surface surface);

// Largest distance of two points, exact; 0 without points.
double diameter_of(Points points);

// Nearest of some points along the edges; among equally near ones, the first in the list.
struct NearestSource {
  std::int32_t source = -1;  // index in the list; -1: none within reach
  double distance = std::numeric_limits<double>::infinity();
};
// n, for all points in one search from all sources, which ends at distance > reach.
std::vector<NearestSource> nearest_sources(const SurfaceGraph& graph, std::span<const std::int32_t> sources,
                                           double reach);

}  // namespace salbench
