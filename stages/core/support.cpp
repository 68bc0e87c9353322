// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/support.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/mesh_ops.h"

namespace salbench {

std::array<double, 2> mean_neighbour_counts(std::span<const Vec3> points, const KdTree& tree, double small,
                                            double large) {
  CHECK_EQ(points.size(), tree.size());
  CHECK_GT(points.size(), 0U);
  const auto pairs = tree.count_pairs_within(small, large);
  const auto mean = [&](std::size_t count) {
    return static_cast<double>(2 * count) / static_cast<double>(points.size());
  };
  return {mean(pairs[0]), mean(pairs[1])};
}

namespace {

// Radii that grow by a tenth each, and the mean number of neighbours within them.
class Growth {
 public:
  Growth(std::span<const Vec3> points, const KdTree& tree, double first)
      : points_(points), tree_(tree), radii_{first} {}

  double radius(std::size_t step) {
    while (radii_.size() <= step) radii_.push_back(radii_.back() * kFactor);
    return radii_[step];
  }
  // At the step before, where there is one, and at the step.
  std::pair<std::int32_t, std::int32_t> neighbours(std::size_t step) {
    const auto [before, at] =
        mean_neighbour_counts(points_, tree_, radius(step > 0 ? step - 1 : 0), radius(step));
    return {step > 0 ? static_cast<std::int32_t>(before) : -1, static_cast<std::int32_t>(at)};
  }

  // A step that holds about so many neighbours, from a few of the points.
  std::size_t likely(std::int32_t enough) {
    std::vector<double> squared;
    std::vector<Neighbour> near;
    const std::size_t stride = points_.size() / kProbes + 1;
    for (std::size_t i = 0; i < points_.size(); i += stride) {
      tree_.nearest(points_[i], static_cast<std::size_t>(enough) + 1, near);
      squared.push_back(near.back().distance_squared);
    }
    const auto middle = squared.begin() + static_cast<std::ptrdiff_t>(squared.size() / 2);
    std::nth_element(squared.begin(), middle, squared.end());
    const double steps = (std::log(*middle) / 2 - std::log(radii_.front())) / std::log(kFactor);
    return steps > 0 ? static_cast<std::size_t>(steps) : 0;
  }

 private:
  static constexpr double kFactor = 1.1;
  static constexpr std::size_t kProbes = 100;

  std::span<const Vec3> points_;
  const KdTree& tree_;
  std::vector<double> radii_;
};

}  // namespace

SupportRadius grown_support_radius(std::span<const Vec3> points, const KdTree& tree, double factor,
                                   std::int32_t enough) {
  CHECK_GT(factor, 0.0);
  if (points.empty()) throw ShapeError("the shape has no points");
  // The search below ends only for finite coordinates: at 2 R every point reaches every other.
  if (!std::all_of(points.begin(), points.end(), [](const Vec3& p) { return p.allFinite(); }))
    throw ShapeError("the shape has a coordinate that is not finite");
  const double extent = bounding_radius(points);
  // Below that a tenth more may be lost in rounding, and the radius would not grow.
  const double first = extent > 0 ? std::max(factor * extent, std::numeric_limits<double>::min()) : 0;
  enough = static_cast<std::int32_t>(std::min(static_cast<std::size_t>(enough), points.size() - 1));

  // The count grows with the radius: from a likely step, the first that holds enough is up or down.
  Growth growth(points, tree, first);
  std::size_t step = first > 0 ? growth.likely(enough) : 0;
  auto [before, held] = growth.neighbours(step);
  while (held < enough) std::tie(before, held) = growth.neighbours(++step);
  while (before >= enough) std::tie(before, held) = growth.neighbours(--step);
  return {growth.radius(step), held};
}

SupportRadius grown_support_radius(std::span<const Vec3> points, double factor) {
  return grown_support_radius(points, KdTree(points), factor);
}

double median_spacing(const NearestPoints& near) {
  const std::size_t other = near.each() < 2 ? 0 : 1;  // without another, the point itself
  std::vector<double> squared;
  squared.reserve(near.size());
  for (std::size_t i = 0; i < near.size(); ++i) squared.push_back(near.of(i)[other].distance_squared);
  if (squared.empty()) return 0;
  const auto middle = squared.begin() + static_cast<std::ptrdiff_t>(squared.size() / 2);
  std::nth_element(squared.begin(), middle, squared.end());
  return std::sqrt(*middle);
}

}  // namespace salbench
