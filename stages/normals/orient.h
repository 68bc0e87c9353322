// SPDX-License-Identifier: GPL-3.0-or-later
// Consistent orientation of normals by Hoppe's minimum spanning tree.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <span>

#include "stages/core/types.h"
#include "stages/geometry/neighbours.h"

namespace salbench {

// Graph along which orientation propagates: connects each point to its nearest others by edges within the
// limits.
struct OrientationGraph {
  std::int32_t neighbours;  // >= 2
  double longest_edge = std::numeric_limits<double>::infinity();
  double largest_turn = std::numbers::pi / 2;  // between an edge's normals, regardless of sign; radians

  // Number of neighbours searched around each of n points, including the point itself.
  std::size_t searched(std::size_t n) const { return std::min(static_cast<std::size_t>(neighbours) + 1, n); }
};

// A point of known orientation: its normal makes no obtuse angle with `towards`.
struct OrientationSeed {
  std::int32_t point;
  Vec3 towards;
};

// Chooses the seed of one connected component of the graph, given as ascending point indices.
using SeedRule = std::function<OrientationSeed(std::span<const std::int32_t> component)>;

// Turns unit normals consistently along a spanning tree of each component of the graph, grown from the
// component's seed; the tree prefers pairs of parallel normals. `near` has graph.searched(n) points for each
// of the n. [hoppe1992]
void orient_normals(std::span<const Vec3> points, const NearestPoints& near, const OrientationGraph& graph,
                    const SeedRule& seed_of, Normals& normals);

}  // namespace salbench
