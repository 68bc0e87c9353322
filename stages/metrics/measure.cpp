// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/measure.h"

#include <numeric>
#include <optional>

#include "stages/core/check.h"

namespace salbench {

Measure vertex_measure(std::size_t n) { return {std::vector<double>(n, 1.0), static_cast<double>(n), 1}; }

Measure area_measure(std::span<const double> areas) {
  const double total = std::accumulate(areas.begin(), areas.end(), 0.0);
  return {{areas.begin(), areas.end()}, total, total};
}

ScalarField barycentric_areas(Points points, Surface surface) {
  ScalarField areas(points.size(), 0.0);
  for (const Triangle& face : surface) {
    const Vec3& a = points[static_cast<std::size_t>(face[0])];
    const Vec3& b = points[static_cast<std::size_t>(face[1])];
    const Vec3& c = points[static_cast<std::size_t>(face[2])];
    const double third = (b - a).cross(c - a).norm() / 6;
    for (const std::int32_t i : face) areas[static_cast<std::size_t>(i)] += third;
  }
  return areas;
}

bool is_constant(std::span<const double> field, const Measure& measure) {
  CHECK_EQ(field.size(), measure.size());
  std::optional<double> first;
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (!(measure.weight[i] > 0)) continue;
    if (!first) first = field[i];
    if (field[i] != *first) return false;
  }
  return true;
}

}  // namespace salbench
