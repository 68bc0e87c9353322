// SPDX-License-Identifier: GPL-3.0-or-later
// Interpolates values known at some positions to the points of a shape.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "stages/core/parallel.h"
#include "stages/core/types.h"
#include "stages/geometry/neighbours.h"

namespace salbench {

inline constexpr std::size_t kInterpolated = 3;  // number of positions in an interpolation

// Mean of the values of the tree's nearest positions, weighted by inverse distance; a point at one of them
// takes its value. `values` has one per position, at least one.
template <class Value>
std::vector<Value> interpolated(std::span<const Vec3> points, const KdTree& tree,
                                const std::vector<Value>& values) {
  std::vector<Value> result(points.size());
  parallel_ranges(points.size(), kPointGrain, [&](std::size_t first, std::size_t last) {
    std::vector<Neighbour> nearest;
    for (std::size_t i = first; i < last; ++i) {
      tree.nearest(points[i], kInterpolated, nearest);
      if (nearest.front().coincides()) nearest.resize(1);
      result[i] = values[static_cast<std::size_t>(nearest.front().index)];
      if (nearest.size() == 1) continue;
      double weights = 1 / std::sqrt(nearest.front().distance_squared);
      for (std::size_t k = 1; k < nearest.size(); ++k) {
        const double weight = 1 / std::sqrt(nearest[k].distance_squared);
        weights += weight;  // running mean
        result[i] += weight / weights * (values[static_cast<std::size_t>(nearest[k].index)] - result[i]);
      }
    }
  });
  return result;
}

// Replaces NaN by the value of the nearest point that has one; all become 0 if none has.
inline void fill_from_nearest(Points points, ScalarField& values) {
  if (!fill_from_nearest(points, values, [](double value) { return !std::isnan(value); }))
    values.assign(values.size(), 0.0);
}

}  // namespace salbench
