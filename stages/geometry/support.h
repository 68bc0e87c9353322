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

inline constexpr std::int32_t kMinMeanNeighbours = 6;  // the point itself excluded

// Mean over the points of the tree of how many others lie at distance <= small, and <= large; n > 0. Nothing
// if it is more than `most` for the large one, which is noticed after about so many for each point.
std::optional<std::array<double, 2>> mean_neighbour_counts(const KdTree& tree, double small, double large,
                                                           double most);

// Largest mean number of others within `radius` that neighbourhoods are computed with, since time and memory
// are in proportion to it: 1000, or what n points have that fill their extent, if that is more. For x =
// radius / R these are the larger of 1.25 x n, a quarter more than even points on a straight line have, and
// 50 x^2 n, 200 times as many as on a sphere. Of the real meshes at hand, 0.0033 n are within 0.02 R at most,
// and 0.07 n within 0.1 R.
double most_mean_neighbours(std::size_t n, double radius, double bounding_radius);

// Throws InputError for more, as of a shape with a stray point, whose R says nothing about the rest. `tree`
// is over `points`, or over some of them.
void require_few_neighbours(std::span<const Vec3> points, const KdTree& tree, double radius);
// The same where somebody else has counted more than `many`.
[[noreturn]] void fail_with_many_neighbours(std::span<const Vec3> points, double radius, double many);

// Median distance of a point to its nearest other one; 0 for fewer than two points. `near` has two or more of
// each.
double median_spacing(const NearestPoints& near);

struct SupportRadius {
  double radius = 0;            // in the shape's unit
  std::int32_t neighbours = 0;  // mean number of others within it, truncated
};

// factor * R, multiplied by 1.1 until the truncated mean number of neighbours is at least `enough` or, where
// there are fewer other points, n - 1. The radius is 0 if all points coincide. Throws InputError if there are
// no points or one is not finite, and as require_few_neighbours does of factor * R; factor > 0. [tasse2016]
SupportRadius grown_support_radius(std::span<const Vec3> points, const KdTree& tree, double factor,
                                   std::int32_t enough = kMinMeanNeighbours);
SupportRadius grown_support_radius(std::span<const Vec3> points, double factor);  // builds the tree

}  // namespace salbench
