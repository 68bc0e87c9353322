// SPDX-License-Identifier: GPL-3.0-or-later
// Only distances are compared: nothing needs exact predicates.
#include "stages/geometry/nearest_face.h"

#include <array>
#include <cstdint>
#include <vector>

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include "stages/core/errors.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Corners = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Corners::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 cgal(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

// Of a point in the plane of a face with an area; clamped, as it is on the face but for rounding.
Vec3 weights_in(const Mesh& mesh, const Triangle& face, const Vec3& place) {
  const auto [a, b, c] =
      std::array{Vec3(mesh.vertices[index(face[0])] - place), Vec3(mesh.vertices[index(face[1])] - place),
                 Vec3(mesh.vertices[index(face[2])] - place)};
  const Vec3 normal = face_area_vector(mesh, face);
  Vec3 shares(normal.dot(b.cross(c)), normal.dot(c.cross(a)), normal.dot(a.cross(b)));
  shares = shares.cwiseMax(0.0);
  return shares / shares.sum();
}

}  // namespace

struct NearestFace::Impl {
  const Mesh& mesh;
  Corners corners = {};
  std::vector<std::uint32_t> numbers = {};  // of the faces: those without an area are not there
  Tree tree = {};

  explicit Impl(const Mesh& of) : mesh(of) {
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
      const Triangle& face = mesh.faces[f];
      if (!(face_area_vector(mesh, face).squaredNorm() > 0)) continue;
      corners.emplace_back(cgal(mesh.vertices[index(face[0])]), cgal(mesh.vertices[index(face[1])]),
                           cgal(mesh.vertices[index(face[2])]));
      numbers.push_back(static_cast<std::uint32_t>(f));
    }
    if (corners.empty()) throw ShapeError("no face has an area: nobody can have looked at one");
    tree.rebuild(corners.begin(), corners.end());
    tree.accelerate_distance_queries();
  }
};

NearestFace::NearestFace(const Mesh& mesh) : impl_(std::make_unique<const Impl>(mesh)) {}
NearestFace::~NearestFace() = default;

FirstHit NearestFace::to(const Vec3& place) const {
  const auto [point, primitive] = impl_->tree.closest_point_and_primitive(cgal(place));
  const std::uint32_t face = impl_->numbers[static_cast<std::size_t>(primitive - impl_->corners.cbegin())];
  const Vec3 nearest(point.x(), point.y(), point.z());
  return {face, weights_in(impl_->mesh, impl_->mesh.faces[face], nearest), (nearest - place).norm()};
}

}  // namespace salbench
