// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/point_cloud.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {
namespace {

void drop_points_without_position(PointCloud& cloud, std::vector<std::string>& warnings) {
  const std::size_t n = cloud.points.size();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!cloud.points[i].allFinite()) {
      cloud.dropped.push_back(static_cast<std::int32_t>(i));
      continue;
    }
    cloud.points[kept] = cloud.points[i];
    if (!cloud.normals.empty()) cloud.normals[kept] = cloud.normals[i];
    ++kept;
  }
  cloud.points.resize(kept);
  if (!cloud.normals.empty()) cloud.normals.resize(kept);
  if (kept < n)
    warnings.push_back(std::to_string(n - kept) + " of " + std::to_string(n) +
                       " points dropped: they have no position");
}

void check_points(const std::vector<Vec3>& points) {
  if (points.size() < kFewestPoints)
    throw ShapeError("the point cloud has " + std::to_string(points.size()) +
                     " points with a position: it needs at least " + std::to_string(kFewestPoints));
  if (const std::string wrong = wrong_with_extent(points); !wrong.empty()) throw ShapeError(wrong);
}

void check_viewpoint(const PointCloud& cloud) {
  if (cloud.viewpoint && !wrong_with_coordinates(std::span(&*cloud.viewpoint, 1)).empty())
    throw ShapeError(
        fmt::format("the viewpoint has a coordinate that is not finite or above {:g}: correct it, "
                    "or leave it out of the file",
                    kLargestCoordinate));
}

std::string without_normal(const PointCloud& cloud, std::size_t first, std::size_t count) {
  // Number of the point in the file, counting dropped ones.
  auto number = static_cast<std::int32_t>(first);
  for (const std::int32_t dropped : cloud.dropped) number += dropped <= number ? 1 : 0;
  return std::to_string(count) + " points have a zero or not finite normal, the first is point " +
         std::to_string(number) +
         " (0-based): correct them, or leave all normals out of the file, so that they are computed";
}

void check_normals(PointCloud& cloud, std::vector<std::string>& warnings) {
  if (cloud.normals.empty()) return;
  CHECK_EQ(cloud.normals.size(), cloud.points.size());
  if (std::ranges::all_of(cloud.normals, [](const Vec3& n) { return n.isZero(0); })) {
    cloud.normals.clear();
    warnings.emplace_back("all normals in the file are zero: they are computed");
    return;
  }
  constexpr double kRounding = 8 * std::numeric_limits<double>::epsilon();  // for a squared length of 1
  std::size_t first = 0, bad = 0;
  for (std::size_t i = 0; i < cloud.normals.size(); ++i) {
    Vec3& normal = cloud.normals[i];
    if (std::abs(normal.squaredNorm() - 1) <= kRounding) continue;
    const double length = normal.stableNorm();
    if (std::isfinite(length) && length > 0)
      normal /= length;
    else if (bad++ == 0)
      first = i;
  }
  if (bad > 0) throw ShapeError(without_normal(cloud, first, bad));
}

}  // namespace

CheckedCloud check_cloud(PointCloud cloud) {
  CheckedCloud checked;
  drop_points_without_position(cloud, checked.warnings);
  check_points(cloud.points);
  check_viewpoint(cloud);
  check_normals(cloud, checked.warnings);
  checked.cloud = std::move(cloud);
  return checked;
}

std::vector<std::int32_t> numbers_left(const PointCloud& cloud) {
  std::vector<std::int32_t> numbers(cloud.size_in_file(), 0);
  for (const std::int32_t dropped : cloud.dropped) numbers[static_cast<std::size_t>(dropped)] = -1;
  std::int32_t next = 0;
  for (std::int32_t& number : numbers)
    if (number == 0) number = next++;
  return numbers;
}

ScalarField values_left(const PointCloud& cloud, const ScalarField& in_file) {
  CHECK_EQ(in_file.size(), cloud.size_in_file());
  const std::vector<std::int32_t> numbers = numbers_left(cloud);
  ScalarField values;
  values.reserve(cloud.points.size());
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (numbers[i] >= 0) values.push_back(in_file[i]);
  return values;
}

std::vector<std::vector<std::int32_t>> picks_left(const PointCloud& cloud,
                                                  std::vector<std::vector<std::int32_t>> in_file) {
  const std::vector<std::int32_t> numbers = numbers_left(cloud);
  for (std::size_t k = 0; k < in_file.size(); ++k)
    for (std::int32_t& pick : in_file[k]) {
      const std::int32_t left = numbers.at(static_cast<std::size_t>(pick));
      if (left < 0)
        throw ShapeError("participant " + std::to_string(k) + " picked point " + std::to_string(pick) +
                         " (0-based), which has no position");
      pick = left;
    }
  return in_file;
}

}  // namespace salbench
