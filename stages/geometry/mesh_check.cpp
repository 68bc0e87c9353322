// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/mesh_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>
#include <tuple>
#include <utility>

#include "stages/core/errors.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {
namespace {

const Vec3& corner(const Mesh& mesh, const Triangle& face, std::size_t i) {
  return mesh.vertices[static_cast<std::size_t>(face[i])];
}

void check_indices(const Mesh& mesh) {
  const auto n = static_cast<std::int64_t>(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.faces.size(); ++i)
    for (const std::int32_t v : mesh.faces[i])
      if (v < 0 || v >= n)
        throw ShapeError("face " + std::to_string(i) + " (0-based) refers to vertex " + std::to_string(v) +
                         ", but the vertices are 0 to " + std::to_string(n - 1));
}

bool repeats_a_vertex(const Triangle& face) {
  return face[0] == face[1] || face[1] == face[2] || face[2] == face[0];
}

// Cheap test that holds for nearly every triangle: by squares, the height is several times the rounding
// threshold below. False if squares underflow.
bool has_much_area(const Mesh& mesh, const Triangle& face) {
  const Vec3 &a = corner(mesh, face, 0), &b = corner(mesh, face, 1), &c = corner(mesh, face, 2);
  const Vec3 ab = b - a, ac = c - a;
  const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (c - b).squaredNorm()});
  const double largest = std::max({a.squaredNorm(), b.squaredNorm(), c.squaredNorm()});
  constexpr double kRounding = 32 * std::numeric_limits<double>::epsilon();
  return ab.cross(ac).squaredNorm() > kRounding * kRounding * largest * longest;
}

// Collinear vertices rarely have a height of exactly zero, because each coordinate is rounded to half a unit
// in the last place. A height over the longest edge within that rounding counts as zero. Lengths are relative
// to that edge, so the test is the same at any scale.
bool has_no_area(const Mesh& mesh, const Triangle& face) {
  if (has_much_area(mesh, face)) return false;
  double longest = 0, largest_coordinate = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    longest = std::max(longest, (corner(mesh, face, (i + 1) % 3) - corner(mesh, face, i)).stableNorm());
    largest_coordinate = std::max(largest_coordinate, corner(mesh, face, i).cwiseAbs().maxCoeff());
  }
  if (longest == 0) return true;
  const Vec3 a = (corner(mesh, face, 1) - corner(mesh, face, 0)) / longest;
  const Vec3 b = (corner(mesh, face, 2) - corner(mesh, face, 0)) / longest;
  const double relative_height = a.cross(b).norm();
  return !(relative_height > 4 * std::numeric_limits<double>::epsilon() * (largest_coordinate / longest));
}

// Keeps the first of several faces over the same vertices.
std::int64_t drop_duplicate_faces(std::size_t n_vertices, std::vector<Triangle>& faces) {
  struct Sorted {
    Triangle corners;
    std::size_t place;
  };
  std::vector<Sorted> by_vertices(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    by_vertices[i] = {faces[i], i};
    std::sort(by_vertices[i].corners.begin(), by_vertices[i].corners.end());
  }
  by_vertices = sorted_by_point(
      n_vertices, by_vertices, [](const Sorted& face) { return face.corners[0]; },
      [](const Sorted& a, const Sorted& b) {
        return std::tie(a.corners, a.place) < std::tie(b.corners, b.place);
      });
  std::vector<bool> is_duplicate(faces.size(), false);
  for (std::size_t i = 1; i < by_vertices.size(); ++i)
    is_duplicate[by_vertices[i].place] = by_vertices[i].corners == by_vertices[i - 1].corners;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < faces.size(); ++i)
    if (!is_duplicate[i]) faces[kept++] = faces[i];
  faces.resize(kept);
  return static_cast<std::int64_t>(by_vertices.size() - kept);
}

void count_parts(const Mesh& mesh, MeshReport& report) {
  const Adjacency adjacency = edge_adjacency(mesh.vertices.size(), mesh.faces);
  for (std::size_t i = 0; i < adjacency.size(); ++i) report.isolated_vertices += adjacency.of(i).empty();
  const std::vector<std::int32_t> labels = connected_components(adjacency);
  // The labelling counts each isolated vertex as a component.
  const std::int64_t all = 1 + *std::ranges::max_element(labels);
  report.components = static_cast<std::int32_t>(all - report.isolated_vertices);
}

void count_edges(std::size_t n_vertices, Surface faces, MeshReport& report) {
  for_each_edge(edge_sides(n_vertices, faces), [&](std::span<const EdgeSide> edge) {
    report.boundary_edges += edge.size() == 1;
    report.nonmanifold_edges += edge.size() > 2;
    report.misoriented_edges += edge.size() == 2 && edge[0].upwards == edge[1].upwards;
  });
}

}  // namespace

CheckedMesh check_mesh(Mesh mesh) {
  if (mesh.vertices.empty()) throw ShapeError("the mesh has no vertices");
  if (mesh.faces.empty()) throw ShapeError("no faces: this is a point cloud; write it as PLY, PCD or XYZ");
  if (const std::string wrong = wrong_with_extent(mesh.vertices); !wrong.empty()) throw ShapeError(wrong);
  check_indices(mesh);
  MeshReport report;
  report.degenerate_faces = static_cast<std::int64_t>(std::erase_if(mesh.faces, repeats_a_vertex));
  report.duplicate_faces = drop_duplicate_faces(mesh.vertices.size(), mesh.faces);
  count_edges(mesh.vertices.size(), mesh.faces, report);
  report.degenerate_faces += static_cast<std::int64_t>(
      std::erase_if(mesh.faces, [&](const Triangle& face) { return has_no_area(mesh, face); }));
  if (!(surface_area(mesh) > 0))
    throw ShapeError("all faces are degenerate: each repeats a vertex or has no area");
  count_parts(mesh, report);
  return {std::move(mesh), report};
}

std::vector<std::string> warnings(const MeshReport& report) {
  std::vector<std::string> lines;
  const auto warn_about = [&](std::int64_t count, std::string_view what) {
    if (count > 0) lines.push_back(std::to_string(count) + " " + std::string(what));
  };
  warn_about(report.degenerate_faces, "degenerate faces (repeated vertex or no area) dropped");
  warn_about(report.duplicate_faces, "duplicate faces dropped");
  warn_about(report.components > 1 ? report.components : 0, "connected components: the surface is in pieces");
  warn_about(report.boundary_edges, "boundary edges: the surface is not closed");
  warn_about(report.nonmanifold_edges, "edges in more than two faces: the surface is not a manifold");
  warn_about(report.misoriented_edges,
             "edges between faces of opposite orientation: normals may be wrong there");
  return lines;
}

}  // namespace salbench
