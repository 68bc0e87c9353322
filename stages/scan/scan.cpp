// SPDX-License-Identifier: GPL-3.0-or-later
// Embree finds the faces that a ray may meet, in float and in the frame below; which of them is nearest, and
// where the ray meets it, is decided in double, among those that float puts no farther behind the nearest one
// than kMargin. The ray is cut there at each hit, so that Embree does not search what is hidden. The
// result depends neither on the order in which it visits its tree, which differs with the number of threads
// that built it, nor on the reciprocal estimates of the processor.
//
// Frame of tracing, "local": the centroid at the origin, the square root of the surface area as unit.
#include "stages/scan/scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/geometry/embree.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {
namespace {

constexpr float kMargin = 0.01F;  // local; thousands of times what float is off by
constexpr std::uint32_t kNoFace = std::numeric_limits<std::uint32_t>::max();

// The corners of an icosahedron in the order of the benchmark's views.
Vec3 view_direction(int view) {
  constexpr double c = 0.85065, d = 0.52573;
  static const std::array<Vec3, kViews> corners = {
      Vec3(0, d, -c), Vec3(0, d, c),   Vec3(0, -d, c), Vec3(-d, c, 0), Vec3(-d, -c, 0), Vec3(d, c, 0),
      Vec3(d, -c, 0), Vec3(0, -d, -c), Vec3(c, 0, d),  Vec3(-c, 0, d), Vec3(-c, 0, -d), Vec3(c, 0, -d)};
  return corners[static_cast<std::size_t>(view)].normalized();
}

struct LocalFrame {
  Vec3 origin_in_mesh;
  double unit_in_mesh;

  Vec3 local_from_mesh(const Vec3& p) const { return (p - origin_in_mesh) / unit_in_mesh; }
  Vec3 mesh_from_local(const Vec3& p) const { return origin_in_mesh + unit_in_mesh * p; }
};

LocalFrame local_frame(const Mesh& mesh) {
  const double area = surface_area(mesh);
  if (!(area > 0) || !std::isfinite(area))
    throw ShapeError(fmt::format("the surface area is {}: the mesh cannot be scanned", area));
  return {area_centroid(mesh), std::sqrt(area)};
}

struct Camera {
  Vec3 position;  // local, as are the directions
  Vec3 forward, right, up;

  // Through the image plane at distance 1.
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

// Number of rays on each side of the central one, for corners of faces.
int half_grid(std::span<const Vec3> local_corners, const ScanOptions& options) {
  double radius = 0;
  for (const Vec3& corner : local_corners) radius = std::max(radius, corner.norm());
  const double half_field = radius < options.distance
                                ? std::min(std::asin(radius / options.distance), kMaxHalfField)
                                : kMaxHalfField;
  return static_cast<int>(
      std::ceil(std::tan(half_field) / std::tan(options.step_degrees * kRadiansPerDegree)));
}

// Rows and columns of the grid, counted from the centre.
struct Window {
  int left, right, bottom, top;
};

// The part of the grid that the mesh is seen in: of the whole one, many rays pass it by.
Window window_of(std::span<const Vec3> local_corners, const Camera& camera, const ScanOptions& options) {
  const int half = half_grid(local_corners, options);
  const Window whole{-half, half, -half, half};
  const double step = std::tan(options.step_degrees * kRadiansPerDegree);
  Eigen::AlignedBox2d seen;
  for (const Vec3& corner : local_corners) {
    const Vec3 from_camera = corner - camera.position;
    const double depth = from_camera.dot(camera.forward);
    if (!(depth > 1e-3 * options.distance)) return whole;  // beside the camera, or behind it
    seen.extend(Eigen::Vector2d(from_camera.dot(camera.right), from_camera.dot(camera.up)) / (depth * step));
  }
  // One ray more on each side: Embree sees a little beyond edges.
  const auto first = [&](double edge) {
    return std::max<double>(-half, std::floor(edge - options.phase) - 1);
  };
  const auto last = [&](double edge) { return std::min<double>(half, std::ceil(edge - options.phase) + 1); };
  return {static_cast<int>(first(seen.min().x())), static_cast<int>(last(seen.max().x())),
          static_cast<int>(first(seen.min().y())), static_cast<int>(last(seen.max().y()))};
}

using Corners = std::array<Vec3, 3>;  // of a face

struct Traced {
  const Mesh& mesh;
  LocalFrame frame;
  std::vector<Vec3> local_corners;   // the vertices that are corners of faces, once each
  std::vector<Corners> local_faces;  // a copy for each face: its vertices lie far apart in memory
  embree::Scene scene;

  explicit Traced(const Mesh& of) : mesh(of), frame(local_frame(of)) {
    std::vector<Vec3> local_vertices;
    local_vertices.reserve(mesh.vertices.size());
    for (const Vec3& p : mesh.vertices) local_vertices.push_back(frame.local_from_mesh(p));
    std::vector<bool> is_corner(mesh.vertices.size(), false);
    local_faces.reserve(mesh.faces.size());
    for (const Triangle& face : mesh.faces) {
      Corners& corners = local_faces.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const auto v = static_cast<std::size_t>(face[k]);
        is_corner[v] = true;
        corners[k] = local_vertices[v];
      }
    }
    for (std::size_t v = 0; v < is_corner.size(); ++v)
      if (is_corner[v]) local_corners.push_back(local_vertices[v]);
    scene = embree::scene_of_triangles(local_vertices, mesh.faces);
  }

  void prefetch(std::uint32_t face) const {
    __builtin_prefetch(&local_faces[face].front());
    __builtin_prefetch(&local_faces[face].back());
  }
};

// The nearest hit so far of one ray.
struct NearestHit {
  const Traced& from;
  Vec3 origin, direction;  // local

  double depth = std::numeric_limits<double>::infinity();  // of the hit, along the direction
  std::uint32_t face = kNoFace;
  Vec3 weights = Vec3::Zero();  // of the face's corners

  // Embree found the face in float. Weights that are negative in double come from that rounding: clamping
  // keeps the point on the face. A face seen exactly edge-on is left to its neighbours.
  void offer(std::uint32_t candidate) {
    const Corners& corners = from.local_faces[candidate];
    const std::array v = {Vec3(corners[0] - origin), Vec3(corners[1] - origin), Vec3(corners[2] - origin)};
    Vec3 shares(direction.dot(v[1].cross(v[2])), direction.dot(v[2].cross(v[0])),
                direction.dot(v[0].cross(v[1])));
    if (shares.sum() < 0) shares = -shares;
    shares = shares.cwiseMax(0.0);
    const double sum = shares.sum();
    if (!(sum > 0)) return;
    shares /= sum;

    const double candidate_depth = direction.dot(shares[0] * v[0] + shares[1] * v[1] + shares[2] * v[2]);
    if (candidate_depth > depth || (candidate_depth == depth && candidate > face)) return;
    depth = candidate_depth;
    face = candidate;
    weights = shares;
  }

  Vec3 point_in_mesh() const {
    Vec3 point = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k)
      point += weights[static_cast<Eigen::Index>(k)] *
               from.mesh.vertices[static_cast<std::size_t>(from.mesh.faces[face][k])];
    return point;
  }
};

}  // namespace

struct ScanScene::Impl : Traced {
  using Traced::Traced;
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
  const Traced& from = *impl_;
  const Camera camera = camera_of_view(view, options);
  const double step = std::tan(options.step_degrees * kRadiansPerDegree);
  const Window window = window_of(from.local_corners, camera, options);
  const Eigen::Vector3f position = camera.position.cast<float>();

  Scan scan{{}, from.frame.mesh_from_local(camera.position)};
  std::vector<embree::Hit> candidates;  // of a row's rays
  struct Traversed {
    std::size_t end;  // of the ray's candidates in the row's
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
      const float limit =
          embree::append_hits(from.scene, position, direction(column).cast<float>(), kMargin, candidates);
      rays.push_back({candidates.size(), limit});
      // Faces are looked at when the row is done; until then they arrive from memory, which each look would
      // wait for.
      for (std::size_t i = first; i < candidates.size(); ++i) from.prefetch(candidates[i].face);
    }
    std::size_t next = 0;
    for (int column = window.left; column <= window.right; ++column) {
      NearestHit nearest{from, camera.position, direction(column)};
      // Whether a face behind the limit was noted depends on the order of the search.
      for (const auto [end, limit] = rays[static_cast<std::size_t>(column - window.left)]; next < end; ++next)
        if (const auto [face, depth] = candidates[next]; depth <= limit) nearest.offer(face);
      if (nearest.face != kNoFace) scan.points.push_back(nearest.point_in_mesh());
    }
  }
  if (scan.points.empty()) throw ShapeError(fmt::format("view {}: no ray meets the mesh", view));
  return scan;
}

}  // namespace salbench
