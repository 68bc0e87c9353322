// SPDX-License-Identifier: GPL-3.0-or-later
// The support radius of descriptors, grown until it holds enough points to describe a neighbourhood.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "stages/core/neighbours.h"
#include "stages/core/types.h"

namespace salbench {

inline constexpr std::int32_t kMinMeanNeighbours = 6;  // the point itself excluded

// Mean over the points of how many others lie at distance <= small, and <= large; n > 0, `tree` is over
// `points`.
std::array<double, 2> mean_neighbour_counts(std::span<const Vec3> points, const KdTree& tree, double small,
                                            double large);

// Median distance of a point to its nearest other one; 0 for fewer than two points. `near` has two or more of
// each.
double median_spacing(const NearestPoints& near);

struct SupportRadius {
  double radius = 0;            // in the shape's unit
  std::int32_t neighbours = 0;  // mean number of others within it, truncated
};

// factor * R, multiplied by 1.1 until the truncated mean number of neighbours is at least `enough` or, where
// there are fewer other points, n - 1. The radius is 0 if all points coincide. Throws InputError if there are
// no points or one is not finite; factor > 0. [tasse2016]
SupportRadius grown_support_radius(std::span<const Vec3> points, const KdTree& tree, double factor,
                                   std::int32_t enough = kMinMeanNeighbours);
SupportRadius grown_support_radius(std::span<const Vec3> points, double factor);  // builds the tree

}  // namespace salbench
