// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/mesh_ops.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <string>
#include <tuple>

#include <fmt/format.h>

#include "stages/core/errors.h"
#include "stages/core/field.h"

namespace salbench {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

}  // namespace

Vec3 centroid(std::span<const Vec3> points) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

bool coincide(std::span<const Vec3> points) {
  return std::ranges::all_of(points, [&](const Vec3& p) { return p == points[0]; });
}

std::string wrong_with_extent(std::span<const Vec3> points) {
  if (points.empty()) return "the shape has no points";
  if (std::string wrong = wrong_with_coordinates(points); !wrong.empty()) return wrong;
  if (coincide(points)) return "all points are in one place";
  Eigen::AlignedBox3d box;
  for (const Vec3& p : points) box.extend(p);
  if (const double extent = box.sizes().maxCoeff(); extent < kSmallestExtent)
    return fmt::format("the shape has an extent of {:g}, expected at least {:g}: scale the shape", extent,
                       kSmallestExtent);
  return {};
}

// The mean of equal numbers may be rounded.
double bounding_radius(std::span<const Vec3> points) {
  if (coincide(points)) return 0;
  const Vec3 centre = centroid(points);
  double largest = 0;
  for (const Vec3& p : points) largest = std::max(largest, (p - centre).squaredNorm());
  return std::sqrt(largest);
}

std::vector<Vec3> in_units_of_radius(std::span<const Vec3> points) {
  if (const std::string wrong = wrong_with_extent(points); !wrong.empty()) throw ShapeError(wrong);
  const Vec3 centre = centroid(points);
  const double radius = bounding_radius(points);
  std::vector<Vec3> result;
  result.reserve(points.size());
  for (const Vec3& p : points) result.push_back((p - centre) / radius);
  return result;
}

void check_faces(std::size_t n_points, Surface surface) {
  for (const Triangle& face : surface)
    for (const std::int32_t v : face)
      if (v < 0 || static_cast<std::size_t>(v) >= n_points)
        throw ShapeError("a face refers to point " + std::to_string(v) + " (0-based), but the shape has " +
                         std::to_string(n_points) + " points");
}

Vec3 face_area_vector(Points points, const Triangle& face) {
  const Vec3& a = at(points, face[0]);
  return (at(points, face[1]) - a).cross(at(points, face[2]) - a);
}

Vec3 face_area_vector(const Mesh& mesh, const Triangle& face) {
  return face_area_vector(mesh.vertices, face);
}

std::vector<Vec3> summed_area_vectors(const Mesh& mesh) {
  std::vector<Vec3> sums(mesh.vertices.size(), Vec3::Zero());
  for (const Triangle& face : mesh.faces)
    for (const std::int32_t i : face) sums[index(i)] += face_area_vector(mesh, face);
  return sums;
}

double surface_area(const Mesh& mesh) {
  double doubled = 0;
  for (const Triangle& face : mesh.faces) doubled += face_area_vector(mesh, face).norm();
  return doubled / 2;
}

ScalarField barycentric_areas(Points points, Surface surface) {
  ScalarField areas(points.size(), 0.0);
  for (const Triangle& face : surface) {
    const double third = face_area_vector(points, face).norm() / 6;
    for (const std::int32_t i : face) areas[static_cast<std::size_t>(i)] += third;
  }
  return areas;
}

Vec3 area_centroid(const Mesh& mesh) {
  Vec3 sum = Vec3::Zero();
  double weights = 0;
  for (const Triangle& face : mesh.faces) {
    const double weight = face_area_vector(mesh, face).norm();
    sum += weight * (at(mesh.vertices, face[0]) + at(mesh.vertices, face[1]) + at(mesh.vertices, face[2]));
    weights += weight;
  }
  return sum / (3 * weights);
}

// Lists each edge from both ends, once per face; degenerate faces have edges from a point to itself.
Adjacency edge_adjacency(std::size_t n_points, std::span<const Triangle> faces) {
  return adjacency_of(n_points, [&](auto&& visit) {
    for (const Triangle& face : faces)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t a = face[k], b = face[(k + 1) % 3];
        if (a == b) continue;
        visit(static_cast<std::size_t>(a), b);
        visit(static_cast<std::size_t>(b), a);
      }
  });
}

std::vector<EdgeSide> edge_sides(std::size_t n_points, Surface faces) {
  std::vector<EdgeSide> sides;
  sides.reserve(3 * faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(faces[i][k], faces[i][(k + 1) % 3]);
      sides.push_back({low, high, static_cast<std::int32_t>(i), faces[i][k] == low});
    }
  return sorted_by_point(
      n_points, sides, [](const EdgeSide& side) { return side.low; },
      [](const EdgeSide& a, const EdgeSide& b) {
        return std::tie(a.high, a.face) < std::tie(b.high, b.face);
      });
}

std::vector<std::int32_t> connected_components(const Adjacency& adjacency) {
  std::vector<std::int32_t> label(adjacency.size(), -1);
  std::vector<std::size_t> open;
  std::int32_t next = 0;
  for (std::size_t start = 0; start < label.size(); ++start) {
    if (label[start] >= 0) continue;
    label[start] = next;
    open.push_back(start);
    while (!open.empty()) {
      const std::size_t i = open.back();
      open.pop_back();
      for (const std::int32_t j : adjacency.of(i)) {
        const auto neighbour = static_cast<std::size_t>(j);
        if (label[neighbour] >= 0) continue;
        label[neighbour] = next;
        open.push_back(neighbour);
      }
    }
    ++next;
  }
  return label;
}

EdgeDistances::EdgeDistances(std::span<const Vec3> points, const Adjacency& adjacency)
    : points_(points), adjacency_(adjacency), distance_(points.size(), kFar) {}

std::span<const ReachedPoint> EdgeDistances::from(std::int32_t source, double reach) {
  for (const ReachedPoint& r : reached_) distance_[static_cast<std::size_t>(r.index)] = kFar;
  reached_.clear();

  // Dijkstra with lazy deletion; pairs order equal distances by index.
  using Entry = std::pair<double, std::int32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  distance_[static_cast<std::size_t>(source)] = 0;
  open.emplace(0.0, source);
  while (!open.empty()) {
    const auto [d, i] = open.top();
    open.pop();
    if (d > distance_[static_cast<std::size_t>(i)]) continue;
    reached_.push_back({i, d});
    for (const std::int32_t j : adjacency_.of(static_cast<std::size_t>(i))) {
      const double through = d + (at(points_, i) - at(points_, j)).norm();
      double& best = distance_[static_cast<std::size_t>(j)];
      if (through > reach || through >= best) continue;
      best = through;
      open.emplace(through, j);
    }
  }
  return reached_;
}

}  // namespace salbench
