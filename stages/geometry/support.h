// SPDX-License-Identifier: GPL-3.0-or-later
// The support radius of descriptors, grown until it holds enough points to describe a neighbourhood.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "stages/core/types.h"
#include "stages/geometry/neighbours.h"

namespace salbench {

inline constexpr std::int32_t kMinMeanNeighbours = 6;  // excluding the point itself

// Mean over the tree's points of the number of others at distance <= small, and <= large; n > 0. nullopt if
// it exceeds `most` for the large one; stops after about that many for each point.
std::optional<std::array<double, 2>> mean_neighbour_counts(const KdTree& tree, double small, double large,
                                                           double most);

// Limit on the mean number of others within `radius`, since time and memory of neighbourhoods are
// proportional to it: 1000, or the number for n points that fill their extent, if that is more. For x =
// radius / R this is the larger of 1.25 x n, a quarter more than for even points on a straight line, and 50
// x^2 n, 200 times as many as on a sphere. Real meshes at hand have at most 0.0033 n within 0.02 R, and 0.07
// n within 0.1 R.
double most_mean_neighbours(std::size_t n, double radius, double bounding_radius);

// Throws InputError for more, as for a shape with a stray point, whose R does not describe the rest. `tree`
// is over `points`, or over some of them.
void require_few_neighbours(std::span<const Vec3> points, const KdTree& tree, double radius);
// The same after a caller has counted more than `many`.
[[noreturn]] void fail_with_many_neighbours(std::span<const Vec3> points, double radius, double many);

// Median distance of a point to its nearest other; 0 for fewer than two points. `near` has at least two per
// point.
double median_spacing(const NearestPoints& near);

struct SupportRadius {
  double radius = 0;            // in the shape's unit
  std::int32_t neighbours = 0;  // mean number of others within it, truncated
};

// factor * R, multiplied by 1.1 until the truncated mean number of neighbours is at least `enough`, or n - 1
// if there are fewer other points. The radius is 0 if all points coincide. Throws InputError if there are no
// points or one is not finite, and like require_few_neighbours for factor * R; factor > 0. [tasse2016]
SupportRadius grown_support_radius(std::span<const Vec3> points, const KdTree& tree, double factor,
                                   std::int32_t enough = kMinMeanNeighbours);
SupportRadius grown_support_radius(std::span<const Vec3> points, double factor);  // builds the tree

}  // namespace salbench
