// SPDX-License-Identifier: GPL-3.0-or-later
// The cotangent Laplacian is summed in a form without divisions: the gradient of a face's area with respect
// to a corner is half the opposite edge, turned by a right angle in the face. Thin faces therefore have
// bounded terms.
#include "stages/models/curvature.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "stages/geometry/mesh_ops.h"
#include "stages/models/interpolated.h"

namespace salbench {
namespace {

constexpr double kOwnNothing = std::numeric_limits<double>::quiet_NaN();
constexpr double kLeastHeight = 1e-12;  // height of a face over its longest edge, relative to it

// A face with its corners in order, and quantities used by both methods.
struct Face {
  Triangle corner;
  std::array<Vec3, 3> opposite;  // edge opposite to the corner, counter-clockwise
  Vec3 normal;                   // unit length
  double area;
};

// Faces with an area.
std::vector<Face> proper_faces(Points points, Surface surface) {
  std::vector<Face> faces;
  faces.reserve(surface.size());
  for (const Triangle& triangle : surface) {
    Face face;
    face.corner = triangle;
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      face.opposite[k] = points[index(triangle[(k + 2) % 3])] - points[index(triangle[(k + 1) % 3])];
      longest = std::max(longest, face.opposite[k].squaredNorm());
    }
    const Vec3 doubled = face_area_vector(points, triangle);
    const double norm = doubled.norm();
    if (!(norm > kLeastHeight * longest)) continue;
    face.normal = doubled / norm;
    face.area = norm / 2;
    faces.push_back(face);
  }
  return faces;
}

// Sum of the faces' normals, weighted by area; not of unit length.
std::vector<Vec3> area_normals(std::size_t n, const std::vector<Face>& faces) {
  std::vector<Vec3> normals(n, Vec3::Zero());
  for (const Face& face : faces)
    for (const std::int32_t i : face.corner) normals[index(i)] += face.area * face.normal;
  return normals;
}

// [point]: true at an edge of a single face, or of three or more.
std::vector<bool> at_irregular_edge(std::size_t n, const std::vector<Face>& faces) {
  Faces corners;
  for (const Face& face : faces) corners.push_back(face.corner);
  std::vector<bool> irregular(n, false);
  for_each_edge(edge_sides(n, corners), [&](std::span<const EdgeSide> edge) {
    if (edge.size() != 2) irregular[index(edge[0].low)] = irregular[index(edge[0].high)] = true;
  });
  return irregular;
}

// Part of a face assigned to each of its corners: its Voronoi region if the face is not obtuse, else a half
// at the obtuse corner and a quarter at the others. [meyer2003]
std::array<double, 3> mixed_areas(const Face& face) {
  std::array<double, 3> dot;  // products of the edges meeting at the corner: negative if obtuse
  for (std::size_t k = 0; k < 3; ++k) dot[k] = -face.opposite[(k + 1) % 3].dot(face.opposite[(k + 2) % 3]);
  std::array<double, 3> areas;
  const bool obtuse = std::ranges::any_of(dot, [](double d) { return d < 0; });
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
    if (obtuse)
      areas[k] = face.area / (dot[k] < 0 ? 2 : 4);
    else  // squared edges at the corner, each times the opposite cotangent
      areas[k] =
          (face.opposite[next].squaredNorm() * dot[next] + face.opposite[last].squaredNorm() * dot[last]) /
          (16 * face.area);
  }
  return areas;
}

ScalarField cotangent_curvature(std::size_t n, const std::vector<Face>& faces) {
  std::vector<Vec3> laplacian(n, Vec3::Zero());  // sum (cot a + cot b) (p - q): points away from the surface
  ScalarField areas(n, 0);
  for (const Face& face : faces) {
    const std::array<double, 3> parts = mixed_areas(face);
    for (std::size_t k = 0; k < 3; ++k) {
      laplacian[index(face.corner[k])] += face.normal.cross(face.opposite[k]);
      areas[index(face.corner[k])] += parts[k];
    }
  }
  const std::vector<Vec3> normals = area_normals(n, faces);
  const std::vector<bool> irregular = at_irregular_edge(n, faces);
  ScalarField curvature(n, kOwnNothing);
  for (std::size_t i = 0; i < n; ++i)
    if (areas[i] > 0 && !irregular[i])
      curvature[i] = std::copysign(laplacian[i].norm() / (4 * areas[i]), laplacian[i].dot(normals[i]));
  return curvature;
}

// Half the trace of Taubin's tensor by his formulas for the principal curvatures, of which only the weighted
// mean of the normal curvatures remains. Curvatures of a convex surface are negative in his convention.
ScalarField taubin_curvature(std::size_t n, const std::vector<Face>& faces) {
  std::vector<Vec3> normals = area_normals(n, faces);
  for (Vec3& normal : normals) normal.stableNormalize();
  ScalarField sums(n, 0), weights(n, 0);
  for (const Face& face : faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = index(face.corner[k]), next = (k + 1) % 3, last = (k + 2) % 3;
      // Edges to the two other corners; every edge occurs in each of its faces.
      for (const Vec3& edge : {face.opposite[last], Vec3(-face.opposite[next])}) {
        sums[i] -= face.area * 2 * normals[i].dot(edge) / edge.squaredNorm();
        weights[i] += face.area;
      }
    }
  ScalarField curvature(n, kOwnNothing);
  for (std::size_t i = 0; i < n; ++i)
    if (weights[i] > 0) curvature[i] = sums[i] / weights[i];
  return curvature;
}

}  // namespace

ScalarField mean_curvature(Points points, Surface surface, CurvatureMethod method) {
  check_faces(points.size(), surface);
  const std::vector<Face> faces = proper_faces(points, surface);
  ScalarField curvature = method == CurvatureMethod::cotangent ? cotangent_curvature(points.size(), faces)
                                                               : taubin_curvature(points.size(), faces);
  fill_from_nearest(points, curvature);
  return curvature;
}

}  // namespace salbench
