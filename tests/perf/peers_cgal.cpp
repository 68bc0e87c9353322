// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <iterator>
#include <stdexcept>
#include <utility>
#include <vector>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <CGAL/mst_orient_normals.h>
#include <CGAL/pca_estimate_normals.h>
#include <CGAL/property_map.h>
#include <benchmark/benchmark.h>

#include "tests/perf/peers.h"

namespace salbench::peers {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;
using OrientedPoint = std::pair<Kernel::Point_3, Kernel::Vector_3>;

SurfaceMesh surface_mesh_of(const Mesh& mesh) {
  SurfaceMesh surface;
  for (const Vec3& p : mesh.vertices) surface.add_vertex({p.x(), p.y(), p.z()});
  for (const Triangle& face : mesh.faces) {
    std::array<SurfaceMesh::Vertex_index, 3> corners;
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = SurfaceMesh::Vertex_index(static_cast<std::uint32_t>(face[k]));
    if (surface.add_face(corners) == SurfaceMesh::null_face())
      throw std::runtime_error("CGAL takes manifold meshes only");
  }
  return surface;
}

// CGAL's own predicates count edges.
struct FewFaces {
  std::size_t most;

  template <class Cost, class Profile>
  bool operator()(const Cost&, const Profile& profile, std::size_t, std::size_t) const {
    return profile.surface_mesh().number_of_faces() <= most;
  }
};

}  // namespace

Work cgal_normals(const Shape& shape, const ScanNormalsOptions& options) {
  std::vector<OrientedPoint> points;
  for (const Vec3& p : shape.scan->points)
    points.emplace_back(Kernel::Point_3(p.x(), p.y(), p.z()), CGAL::NULL_VECTOR);
  return [points = std::move(points), options] {
    std::vector<OrientedPoint> oriented = points;
    const auto maps = CGAL::parameters::point_map(CGAL::First_of_pair_property_map<OrientedPoint>())
                          .normal_map(CGAL::Second_of_pair_property_map<OrientedPoint>());
    // CGAL does not count the point itself.
    CGAL::pca_estimate_normals<CGAL::Sequential_tag>(oriented, static_cast<unsigned>(options.neighbours - 1),
                                                     maps);
    const auto unoriented =
        CGAL::mst_orient_normals(oriented, static_cast<unsigned>(options.orientation_neighbours), maps);
    benchmark::DoNotOptimize(oriented);
    return static_cast<std::size_t>(std::distance(oriented.begin(), unoriented));
  };
}

Work cgal_simplified(const Shape& shape, std::size_t faces) {
  return [mesh = surface_mesh_of(shape.mesh), faces] {
    namespace simplification = CGAL::Surface_mesh_simplification;
    SurfaceMesh coarse = mesh;
    const simplification::GarlandHeckbert_plane_policies<SurfaceMesh, Kernel> policies(coarse);
    simplification::edge_collapse(coarse, FewFaces{faces},
                                  CGAL::parameters::get_cost(policies.get_cost())
                                      .get_placement(policies.get_placement())
                                      .filter(simplification::Bounded_normal_change_filter<>()));
    coarse.collect_garbage();
    benchmark::DoNotOptimize(coarse);
    return static_cast<std::size_t>(coarse.number_of_faces());
  };
}

}  // namespace salbench::peers
