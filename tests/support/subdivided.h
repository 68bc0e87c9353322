// SPDX-License-Identifier: GPL-3.0-or-later
// Refinement of real meshes.
#pragma once

#include <cstddef>
#include <cstdint>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/subdivision_method_3.h>

#include "stages/core/types.h"

namespace salbench {

// Loop subdivision, which leaves no sharp corners. The vertices of the mesh come first, in their order.
inline Mesh subdivided(const Mesh& mesh, unsigned int times) {
  using Point = CGAL::Simple_cartesian<double>::Point_3;
  CGAL::Surface_mesh<Point> surface;
  for (const Vec3& p : mesh.vertices) surface.add_vertex({p.x(), p.y(), p.z()});
  const auto vertex = [](std::int32_t v) { return CGAL::SM_Vertex_index(static_cast<std::uint32_t>(v)); };
  for (const auto& [a, b, c] : mesh.faces) surface.add_face(vertex(a), vertex(b), vertex(c));
  CGAL::Subdivision_method_3::Loop_subdivision(surface, CGAL::parameters::number_of_iterations(times));
  Mesh fine;
  for (const auto v : surface.vertices()) {
    const Point& p = surface.point(v);
    fine.vertices.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto f : surface.faces()) {
    Triangle face;
    std::size_t k = 0;
    for (const auto v : surface.vertices_around_face(surface.halfedge(f)))
      face[k++] = static_cast<std::int32_t>(v.idx());
    fine.faces.push_back(face);
  }
  return fine;
}

}  // namespace salbench
