// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/first_hit.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "stages/core/errors.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {
namespace {

double area_of(const Mesh& mesh) {
  const double area = surface_area(mesh);
  if (!(area > 0) || !std::isfinite(area))
    throw ShapeError(fmt::format("the surface area is {}: the mesh cannot be scanned", area));
  return area;
}

// Barycentric weights of the triangle's point nearest to the origin: inside, or on the nearest edge.
Vec3 nearest_weights(const TracedMesh::Corners& v) {
  const Vec3 normal = (v[1] - v[0]).cross(v[2] - v[0]);
  const Vec3 within(normal.dot(v[1].cross(v[2])), normal.dot(v[2].cross(v[0])), normal.dot(v[0].cross(v[1])));
  if (within.minCoeff() >= 0 && within.sum() > 0) return within / within.sum();
  Vec3 best = Vec3::UnitX();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &a = v[k], along = v[(k + 1) % 3] - a;
    const double squared = along.squaredNorm();
    const double share = squared > 0 ? std::clamp(-a.dot(along) / squared, 0.0, 1.0) : 0;
    const double distance = (a + share * along).squaredNorm();
    if (!(distance < least)) continue;
    least = distance;
    best = Vec3::Zero();
    best[static_cast<Eigen::Index>(k)] = 1 - share;
    best[static_cast<Eigen::Index>((k + 1) % 3)] = share;
  }
  return best;
}

}  // namespace

Vec3 FirstHit::point_in(const Mesh& mesh) const {
  Vec3 point = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k)
    point += weights[static_cast<Eigen::Index>(k)] * mesh.vertices[index(mesh.faces[face][k])];
  return point;
}

TracedMesh::TracedMesh(const Mesh& mesh)
    : mesh_(mesh), unit_(std::sqrt(area_of(mesh))), origin_(area_centroid(mesh)) {
  std::vector<Vec3> local;
  local.reserve(mesh.vertices.size());
  for (const Vec3& p : mesh.vertices) local.push_back(local_from_mesh(p));
  std::vector<bool> is_corner(local.size(), false);
  of_faces_.reserve(mesh.faces.size());
  for (const Triangle& face : mesh.faces) {
    Corners& corners = of_faces_.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      is_corner[index(face[k])] = true;
      corners[k] = local[index(face[k])];
    }
  }
  for (std::size_t v = 0; v < is_corner.size(); ++v)
    if (is_corner[v]) corners_.push_back(local[v]);
  for (const Vec3& corner : corners_) radius_ = std::max(radius_, corner.norm());
  scene_ = embree::scene_of_triangles(local, mesh.faces);
}

float TracedMesh::append_candidates(const Vec3& origin, const Vec3& direction,
                                    std::vector<embree::Hit>& hits) const {
  return embree::append_hits(scene_, origin.cast<float>(), direction.cast<float>(), kMargin, hits);
}

void TracedMesh::prefetch(std::uint32_t face) const {
  __builtin_prefetch(&of_faces_[face].front());
  __builtin_prefetch(&of_faces_[face].back());
}

void TracedMesh::offer(const Vec3& origin, const Vec3& direction, std::uint32_t face,
                       FirstHit& nearest) const {
  const Corners& corners = of_faces_[face];
  const std::array v = {Vec3(corners[0] - origin), Vec3(corners[1] - origin), Vec3(corners[2] - origin)};
  Vec3 shares(direction.dot(v[1].cross(v[2])), direction.dot(v[2].cross(v[0])),
              direction.dot(v[0].cross(v[1])));
  if (shares.sum() < 0) shares = -shares;
  shares = shares.cwiseMax(0.0);
  const double sum = shares.sum();
  if (!(sum > 0)) return;
  shares /= sum;

  const double depth = direction.dot(shares[0] * v[0] + shares[1] * v[1] + shares[2] * v[2]);
  if (depth > nearest.depth || (depth == nearest.depth && face > nearest.face)) return;
  nearest = {face, shares, depth};
}

FirstHit TracedMesh::first_hit(const Vec3& origin, const Vec3& direction) const {
  // Starts at the sphere around the mesh: float lacks precision for a distant eye.
  const Vec3 eye = local_from_mesh(origin);
  const double to_centre = -eye.dot(direction), radius = 1.001 * radius_;
  const double ahead = std::max(0.0, to_centre - radius);
  const Vec3 from = eye + ahead * direction;
  FirstHit nearest;
  if ((eye + to_centre * direction).norm() > radius) return nearest;
  std::vector<embree::Hit> candidates;
  const float limit = append_candidates(from, direction, candidates);
  for (const auto& [face, depth] : candidates)
    if (depth <= limit) offer(from, direction, face, nearest);
  if (nearest) nearest.depth = (nearest.depth + ahead) * unit_;
  return nearest;
}

FirstHit TracedMesh::nearest(const Vec3& place, double reach) const {
  const Vec3 at = local_from_mesh(place);
  FirstHit found;
  double least = std::nextafter(reach / unit_, std::numeric_limits<double>::infinity());
  embree::visit_near(scene_, at.cast<float>(), static_cast<float>(least) + kMargin, [&](std::uint32_t face) {
    const Corners& corners = of_faces_[face];
    const Vec3 weights = nearest_weights({corners[0] - at, corners[1] - at, corners[2] - at});
    const double distance =
        (weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2] - at).norm();
    if (distance < least || (distance == least && face < found.face)) {
      found = {face, weights, distance * unit_};
      least = distance;
    }
    return static_cast<float>(least) + kMargin;
  });
  return found;
}

}  // namespace salbench
