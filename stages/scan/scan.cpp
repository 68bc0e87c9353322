// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/scan/scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/geometry/first_hit.h"

namespace salbench {
namespace {

// Corners of an icosahedron in the order of the benchmark's views.
Vec3 view_direction(int view) {
  constexpr double c = 0.85065, d = 0.52573;
  static const std::array<Vec3, kViews> corners = {
      Vec3(0, d, -c), Vec3(0, d, c),   Vec3(0, -d, c), Vec3(-d, c, 0), Vec3(-d, -c, 0), Vec3(d, c, 0),
      Vec3(d, -c, 0), Vec3(0, -d, -c), Vec3(c, 0, d),  Vec3(-c, 0, d), Vec3(-c, 0, -d), Vec3(c, 0, -d)};
  return corners[static_cast<std::size_t>(view)].normalized();
}

struct Camera {
  Vec3 position;  // local, as the directions
  Vec3 forward, right, up;

  // Ray through the image plane at distance 1.
  Vec3 ray(double x, double y) const { return forward + x * right + y * up; }
};

Camera camera_of_view(int view, const ScanOptions& options) {
  const Vec3 direction = view_direction(view);
  Camera camera{options.distance * direction, -direction, Vec3::Zero(), Vec3::Zero()};
  camera.right = camera.forward.cross(options.up == UpAxis::y ? Vec3::UnitY() : Vec3::UnitZ())
                     .normalized();  // no view looks along an axis
  camera.up = camera.right.cross(camera.forward);
  return camera;
}

// Number of rays on each side of the central one, from the corners of faces.
int half_grid(std::span<const Vec3> local_corners, const ScanOptions& options) {
  double radius = 0;
  for (const Vec3& corner : local_corners) radius = std::max(radius, corner.norm());
  const double half_field = radius < options.distance
                                ? std::min(std::asin(radius / options.distance), kMaxHalfField)
                                : kMaxHalfField;
  return static_cast<int>(
      std::ceil(std::tan(half_field) / std::tan(options.step_degrees * kRadiansPerDegree)));
}

// Rows and columns of the grid, relative to the centre.
struct Window {
  int left, right, bottom, top;
};

// Part of the grid that contains the mesh: many rays of the complete grid would miss it.
Window window_of(std::span<const Vec3> local_corners, const Camera& camera, const ScanOptions& options) {
  const int half = half_grid(local_corners, options);
  const Window whole{-half, half, -half, half};
  const double step = std::tan(options.step_degrees * kRadiansPerDegree);
  Eigen::AlignedBox2d seen;
  for (const Vec3& corner : local_corners) {
    const Vec3 from_camera = corner - camera.position;
    const double depth = from_camera.dot(camera.forward);
    if (!(depth > 1e-3 * options.distance)) return whole;  // beside or behind the camera
    seen.extend(Eigen::Vector2d(from_camera.dot(camera.right), from_camera.dot(camera.up)) / (depth * step));
  }
  // One more ray on each side: Embree's hits extend slightly beyond edges.
  const auto first = [&](double edge) {
    return std::max<double>(-half, std::floor(edge - options.phase) - 1);
  };
  const auto last = [&](double edge) { return std::min<double>(half, std::ceil(edge - options.phase) + 1); };
  return {static_cast<int>(first(seen.min().x())), static_cast<int>(last(seen.max().x())),
          static_cast<int>(first(seen.min().y())), static_cast<int>(last(seen.max().y()))};
}

}  // namespace

struct ScanScene::Impl : TracedMesh {
  using TracedMesh::TracedMesh;
};

ScanScene::ScanScene(const Mesh& mesh) : impl_(std::make_unique<const Impl>(mesh)) {}
ScanScene::ScanScene(ScanScene&&) noexcept = default;
ScanScene& ScanScene::operator=(ScanScene&&) noexcept = default;
ScanScene::~ScanScene() = default;

Scan simulate_scan(const Mesh& mesh, int view, const ScanOptions& options) {
  return ScanScene(mesh).scan(view, options);
}

Scan ScanScene::scan(int view, const ScanOptions& options) const {
  CHECK_LE(0, view);
  CHECK_LT(view, kViews);
  const TracedMesh& from = *impl_;
  const Camera camera = camera_of_view(view, options);
  const double step = std::tan(options.step_degrees * kRadiansPerDegree);
  const Window window = window_of(from.local_corners(), camera, options);

  Scan scan{{}, from.mesh_from_local(camera.position)};
  std::vector<embree::Hit> candidates;  // for one row of rays
  struct Traversed {
    std::size_t end;  // end of the ray's candidates
    float limit;
  };
  std::vector<Traversed> rays;
  for (int row = window.top; row >= window.bottom; --row) {
    const auto direction = [&](int column) {
      return camera.ray((column + options.phase) * step, (row + options.phase) * step);
    };
    candidates.clear();
    rays.clear();
    for (int column = window.left; column <= window.right; ++column) {
      const std::size_t first = candidates.size();
      const float limit = from.append_candidates(camera.position, direction(column), candidates);
      rays.push_back({candidates.size(), limit});
      for (std::size_t i = first; i < candidates.size(); ++i) from.prefetch(candidates[i].face);
    }
    std::size_t next = 0;
    for (int column = window.left; column <= window.right; ++column) {
      FirstHit nearest;
      // Ignores faces behind the limit, since those found depend on the order of the search.
      for (const auto [end, limit] = rays[static_cast<std::size_t>(column - window.left)]; next < end; ++next)
        if (const auto [face, depth] = candidates[next]; depth <= limit)
          from.offer(camera.position, direction(column), face, nearest);
      if (nearest) scan.points.push_back(nearest.point_in(from.mesh()));
    }
  }
  if (scan.points.empty()) throw ShapeError(fmt::format("view {}: no ray meets the mesh", view));
  return scan;
}

}  // namespace salbench
