// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/support.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {

std::optional<std::array<double, 2>> mean_neighbour_counts(const KdTree& tree, double small, double large,
                                                           double most) {
  CHECK_GT(tree.size(), 0U);
  const auto n = static_cast<double>(tree.size());
  const double most_pairs = std::min(most * n / 2, 0x1p62);
  const auto pairs = tree.count_pairs_within(small, large, static_cast<std::size_t>(most_pairs));
  if (!pairs) return {};
  const auto mean = [&](std::size_t count) { return static_cast<double>(2 * count) / n; };
  return {{mean((*pairs)[0]), mean((*pairs)[1])}};
}

double most_mean_neighbours(std::size_t n, double radius, double bounding_radius) {
  constexpr double kMany = 1000, kOnALine = 1.25, kOnASurface = 50;
  const double part = radius / bounding_radius;
  return std::max(kMany, static_cast<double>(n) * std::max(kOnALine * part, kOnASurface * part * part));
}

void fail_with_many_neighbours(std::span<const Vec3> points, double radius, double many) {
  throw ShapeError(
      fmt::format("within {:.3g} R of a point are more than {:.0f} others on average, of {} points: remove "
                  "points far from the rest and points in one place, or thin out where they crowd",
                  radius / bounding_radius(points), many, points.size()));
}

namespace {

// Number of pairs within the radius along the longest side of their box, an upper bound for that in space.
std::size_t pairs_along_a_side(std::span<const Vec3> points, double radius) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : points) box.extend(p);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  std::vector<double> places;
  places.reserve(points.size());
  for (const Vec3& p : points) places.push_back(p[axis]);
  std::ranges::sort(places);
  const auto too_far = [&](double distance) { return distance * distance > radius * radius; };
  std::size_t pairs = 0;
  for (std::size_t first = 0, last = 0; last < places.size(); ++last) {
    while (too_far(places[last] - places[first])) ++first;
    pairs += last - first;
  }
  return pairs;
}

}  // namespace

void require_few_neighbours(std::span<const Vec3> points, const KdTree& tree, double radius) {
  const double extent = bounding_radius(points);
  if (extent == 0) return;
  const double most = most_mean_neighbours(tree.size(), radius, extent);
  if (static_cast<double>(2 * pairs_along_a_side(points, radius)) <= most * static_cast<double>(tree.size()))
    return;  // true for nearly all shapes; takes a tenth of the time of counting
  if (!mean_neighbour_counts(tree, radius, radius, most)) fail_with_many_neighbours(points, radius, most);
}

namespace {

// Radii that grow by a tenth each, with the mean number of neighbours within them.
class Growth {
 public:
  Growth(std::span<const Vec3> points, const KdTree& tree, double first, double most)
      : points_(points), tree_(tree), radii_{first}, most_(most) {}

  double radius(std::size_t step) {
    while (radii_.size() <= step) radii_.push_back(radii_.back() * kFactor);
    return radii_[step];
  }
  // Counts at the previous step, if any, and at this step. Both are kMany if this step exceeds `most`.
  static constexpr std::int32_t kMany = std::numeric_limits<std::int32_t>::max();
  std::pair<std::int32_t, std::int32_t> neighbours(std::size_t step) {
    const auto counts = mean_neighbour_counts(tree_, radius(step > 0 ? step - 1 : 0), radius(step), most_);
    const auto [before, at] = counts.value_or(std::array<double, 2>{kMany, kMany});
    return {step > 0 ? static_cast<std::int32_t>(before) : -1, static_cast<std::int32_t>(at)};
  }

  // Estimated step with about `enough` neighbours, from a sample of the points.
  std::size_t likely(std::int32_t enough) {
    std::vector<double> squared;
    std::vector<Neighbour> near;
    const std::size_t stride = points_.size() / kProbes + 1;
    for (std::size_t i = 0; i < points_.size(); i += stride) {
      tree_.nearest(points_[i], static_cast<std::size_t>(enough) + 1, near);
      squared.push_back(near.back().distance_squared);
    }
    const double steps =
        (std::log(upper_median(std::move(squared))) / 2 - std::log(radii_.front())) / std::log(kFactor);
    return steps > 0 ? static_cast<std::size_t>(steps) : 0;
  }

 private:
  static constexpr double kFactor = 1.1;
  static constexpr std::size_t kProbes = 100;

  std::span<const Vec3> points_;
  const KdTree& tree_;
  std::vector<double> radii_;
  double most_;
};

}  // namespace

SupportRadius grown_support_radius(std::span<const Vec3> points, const KdTree& tree, double factor,
                                   std::int32_t enough) {
  CHECK_GT(factor, 0.0);
  if (points.empty()) throw ShapeError("the shape has no points");
  // Finite coordinates guarantee that the search ends: at 2 R every point reaches every other.
  require_finite(points);
  const std::size_t others = points.size() - 1;
  const double extent = bounding_radius(points);
  if (extent == 0) return {0, static_cast<std::int32_t>(others)};
  // Below this, rounding may lose the growth of a tenth.
  const double first = std::max(factor * extent, std::numeric_limits<double>::min());
  enough = static_cast<std::int32_t>(std::min(static_cast<std::size_t>(enough), others));

  // The count grows with the radius: the first sufficient step is up or down from the estimate.
  const double most = std::max(most_mean_neighbours(points.size(), first, extent), 4.0 * enough);
  Growth growth(points, tree, first, most);
  std::size_t step = growth.likely(enough);
  std::int32_t before = 0, held = 0;
  std::tie(before, held) = growth.neighbours(step);
  while (held == Growth::kMany && step > 0) std::tie(before, held) = growth.neighbours(step /= 2);
  while (held < enough) std::tie(before, held) = growth.neighbours(++step);
  if (held == Growth::kMany) fail_with_many_neighbours(points, growth.radius(step), most);
  while (before >= enough) std::tie(before, held) = growth.neighbours(--step);
  return {growth.radius(step), held};
}

SupportRadius grown_support_radius(std::span<const Vec3> points, double factor) {
  return grown_support_radius(points, KdTree(points), factor);
}

double median_spacing(const NearestPoints& near) {
  const std::size_t other = near.each() < 2 ? 0 : 1;  // the point itself if it has no other
  std::vector<double> squared;
  squared.reserve(near.size());
  for (std::size_t i = 0; i < near.size(); ++i) squared.push_back(near.of(i)[other].distance_squared);
  if (squared.empty()) return 0;
  return std::sqrt(upper_median(std::move(squared)));
}

}  // namespace salbench
