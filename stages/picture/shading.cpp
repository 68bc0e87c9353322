// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/picture/shading.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "stages/geometry/mesh_ops.h"

namespace salbench {
namespace {

// Faces around each point, in their order.
Adjacency faces_around(std::size_t n_points, std::span<const Triangle> faces) {
  return adjacency_of(n_points, [&](auto&& visit) {
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (const std::int32_t point : faces[f]) visit(index(point), static_cast<std::int32_t>(f));
  });
}

}  // namespace

CornerNormals::CornerNormals(std::span<const Vec3> points, std::span<const Triangle> faces,
                             const std::vector<bool>& wanted)
    : planes_(faces.size()), corners_(faces.size()) {
  std::vector<float> areas(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto& [a, b, c] = faces[f];
    const Vec3& p = points[static_cast<std::size_t>(a)];
    const Vec3 normal =
        (points[static_cast<std::size_t>(b)] - p).cross(points[static_cast<std::size_t>(c)] - p);
    planes_[f] = normal.normalized().cast<float>();
    areas[f] = static_cast<float>(normal.norm());
  }
  const Adjacency around = faces_around(points.size(), faces);
  const auto crease = static_cast<float>(std::cos(kCreaseDegrees * kRadiansPerDegree));
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (!wanted[f]) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3f sum = Vec3f::Zero();
      for (const std::int32_t other : around.of(index(faces[f][k]))) {
        const auto o = static_cast<std::size_t>(other);
        const float cosine = planes_[o].dot(planes_[f]);
        if (std::abs(cosine) >= crease) sum += std::copysign(areas[o], cosine) * planes_[o];
      }
      corners_[f][k] = sum.normalized();
    }
  }
}

Vec3f CornerNormals::at(std::int32_t face, const Vec3& weights) const {
  const auto& corners = corners_[static_cast<std::size_t>(face)];
  const Vec3f w = weights.cast<float>();
  return (w[0] * corners[0] + w[1] * corners[1] + w[2] * corners[2]).normalized();
}

Lamp::Lamp(const PictureOptions& options) : ambient_(static_cast<float>(options.ambient)) {
  const double azimuth = options.light_azimuth * kRadiansPerDegree;
  const double elevation = options.light_elevation * kRadiansPerDegree;
  towards_ = Vec3(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                  -std::cos(elevation) * std::cos(azimuth))
                 .cast<float>();
}

// Lambert's law would leave the side away from the lamp black, and shapes must be recognisable there too:
// brightness falls over half a turn instead of a quarter.
float Lamp::brightness(const Vec3f& normal) const {
  const float half = 0.5F + 0.5F * std::clamp(normal.dot(towards_), -1.0F, 1.0F);
  return ambient_ + (1 - ambient_) * half * half;
}

}  // namespace salbench
