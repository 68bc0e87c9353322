#include "stages/core/support.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/mesh_ops.h"

namespace salbench {

double mean_neighbour_count(std::span<const Vec3> points, const KdTree& tree, double radius) {
  CHECK_EQ(points.size(), tree.size());
  CHECK_GT(points.size(), 0U);
  std::vector<Neighbour> found;
  std::size_t others = 0;
  for (const Vec3& p : points) {
    tree.within(p, radius, found);
    others += found.size() - 1;
  }
  return static_cast<double>(others) / static_cast<double>(points.size());
}

SupportRadius grown_support_radius(std::span<const Vec3> points, const KdTree& tree, double factor,
                                   std::int32_t enough) {
  CHECK_GT(factor, 0.0);
  if (points.empty()) throw InputError("the shape has no points");
  SupportRadius support{factor * bounding_radius(points), 0};
  // The loop below ends only for finite coordinates: at 2 R every point reaches every other.
  if (!std::all_of(points.begin(), points.end(), [](const Vec3& p) { return p.allFinite(); }))
    throw InputError("the shape has a coordinate that is not finite");
  enough = static_cast<std::int32_t>(std::min(static_cast<std::size_t>(enough), points.size() - 1));
  while (true) {
    support.neighbours = static_cast<std::int32_t>(mean_neighbour_count(points, tree, support.radius));
    if (support.neighbours >= enough) return support;
    support.radius *= 1.1;
  }
}

SupportRadius grown_support_radius(std::span<const Vec3> points, double factor) {
  return grown_support_radius(points, KdTree(points), factor);
}

double median_spacing(std::span<const Vec3> points, const KdTree& tree) {
  std::vector<double> squared;
  squared.reserve(points.size());
  std::vector<Neighbour> near;
  for (const Vec3& p : points) {
    tree.nearest(p, 2, near);
    squared.push_back(near.back().distance_squared);
  }
  if (squared.empty()) return 0;
  const auto middle = squared.begin() + static_cast<std::ptrdiff_t>(squared.size() / 2);
  std::nth_element(squared.begin(), middle, squared.end());
  return std::sqrt(*middle);
}

}  // namespace salbench
