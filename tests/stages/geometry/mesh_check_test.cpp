// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/mesh_check.h"

#include "stages/geometry/mesh_ops.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(MeshCheck, FindsNothingOddInAClosedSurface) {
  const Mesh sphere = shapes::sphere(2);
  const auto [mesh, report] = check_mesh(sphere);
  EXPECT_EQ(mesh.faces, sphere.faces);
  EXPECT_EQ(report.components, 1);
  EXPECT_THAT(warnings(report), IsEmpty());
}

TEST(MeshCheck, CountsTheBoundaryOfASquare) {
  const MeshReport report = check_mesh(shapes::grid(5)).report;
  EXPECT_EQ(report.boundary_edges, 20);
  EXPECT_THAT(warnings(report), ElementsAre(HasSubstr("20 boundary edges")));
}

TEST(MeshCheck, DropsDegenerateFacesAndKeepsTheVertices) {
  Mesh sphere = shapes::sphere(1);
  const std::size_t n_vertices = sphere.vertices.size() + 3, n_faces = sphere.faces.size();
  const auto v = static_cast<std::int32_t>(sphere.vertices.size());
  sphere.vertices.insert(sphere.vertices.end(), {{0.1, 0.1, 0.1}, {0.2, 0.2, 0.2}, {0.3, 0.3, 0.3}});
  sphere.faces.insert(sphere.faces.begin(), {{4, 4, 7}, {v, v + 1, v + 2}});  // repeated vertex; collinear
  const auto [mesh, report] = check_mesh(sphere);
  EXPECT_EQ(report.degenerate_faces, 2);
  EXPECT_EQ(report.isolated_vertices, 3);
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(mesh.vertices.size(), n_vertices);
  EXPECT_EQ(mesh.faces.size(), n_faces);
}

TEST(MeshCheck, FacesWithoutAreaCloseASurface) {
  Mesh mesh = shapes::tetrahedron();
  // Splits the edge 0-1 of one face in the middle; a flat face fills the gap.
  mesh.vertices.push_back((mesh.vertices[0] + mesh.vertices[1]) / 2);
  mesh.faces.erase(mesh.faces.begin());
  mesh.faces.insert(mesh.faces.end(), {{0, 4, 2}, {4, 1, 2}, {0, 1, 4}});
  const CheckedMesh checked = check_mesh(mesh);
  EXPECT_EQ(checked.report.degenerate_faces, 1);
  EXPECT_EQ(checked.mesh.faces.size(), 5U);
  EXPECT_EQ(checked.report.boundary_edges, 0);
  EXPECT_EQ(checked.report.misoriented_edges, 0);
}

TEST(MeshCheck, CollinearIsJudgedAgainstTheRoundingOfTheCoordinates) {
  const auto degenerate = [](double offset, double height, double scale) {
    Mesh mesh = shapes::tetrahedron();
    mesh.vertices.insert(mesh.vertices.end(),
                         {{offset, 0, 0}, {offset + 1, 0, 0}, {offset + 0.3, height, 0}});
    mesh.faces.push_back({4, 5, 6});
    for (Vec3& vertex : mesh.vertices) vertex *= scale;
    return check_mesh(mesh).report.degenerate_faces;
  };
  for (const double scale : {1e-40, 1.0, 1e40}) {
    EXPECT_EQ(degenerate(0, 1e-9, scale), 0) << scale;
    EXPECT_EQ(degenerate(0, 1e-17, scale), 1) << scale;
    EXPECT_EQ(degenerate(1e6, 1e-8, scale), 0) << scale;
    EXPECT_EQ(degenerate(1e6, 1e-10, scale), 1) << scale;
  }
}

// The longest edge is 1, and so is the largest coordinate: a height up to 4 epsilon is rounding.
TEST(MeshCheck, CollinearDoesNotDependOnWhichCornerComesFirst) {
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  for (const auto& [height, degenerate] : {std::pair(3 * kEpsilon, 1), {5 * kEpsilon, 0}})
    for (const Triangle& face : {Triangle{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}) {
      const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0.5, height, 0}, {0, 1, 0}}, {face, {0, 1, 3}}};
      EXPECT_EQ(check_mesh(mesh).report.degenerate_faces, degenerate)
          << height << ": " << face[0] << face[1] << face[2];
    }
}

TEST(MeshCheck, DropsDuplicatesInAnyOrderOfTheirVerticesAndKeepsTheFirst) {
  Mesh mesh = shapes::tetrahedron();
  const auto [a, b, c] = mesh.faces[1];
  const std::vector<Triangle> once = mesh.faces;
  mesh.faces.insert(mesh.faces.end(), {{b, c, a}, {c, b, a}, {a, b, c}});
  const CheckedMesh checked = check_mesh(mesh);
  EXPECT_EQ(checked.report.duplicate_faces, 3);
  EXPECT_EQ(checked.mesh.faces, once);
}

TEST(MeshCheck, CountsComponentsWithoutIsolatedVertices) {
  Mesh mesh = shapes::joined(shapes::tetrahedron(), shapes::sphere(1), {9, 9, 9});
  mesh.vertices.emplace_back(9, 9, 9);
  const MeshReport report = check_mesh(mesh).report;
  EXPECT_EQ(report.components, 2);
  EXPECT_EQ(report.isolated_vertices, 1);
  EXPECT_THAT(warnings(report), ElementsAre(HasSubstr("2 connected components")));
}

TEST(MeshCheck, CountsEdgesOfThreeFacesAndFacesTurnedOver) {
  Mesh fin = shapes::tetrahedron();
  fin.vertices.emplace_back(5, 0, 0);
  fin.faces.push_back({0, 1, 4});
  EXPECT_EQ(check_mesh(fin).report.nonmanifold_edges, 1);

  Mesh turned = shapes::sphere(1);
  std::swap(turned.faces[7][0], turned.faces[7][1]);
  const MeshReport report = check_mesh(turned).report;
  EXPECT_EQ(report.misoriented_edges, 3);
  EXPECT_EQ(report.boundary_edges, 0);
}

TEST(MeshCheck, RefusesMeshesThatNothingCanBeComputedFrom) {
  const Mesh good = shapes::tetrahedron();
  const auto placed = [&](double scale, double y) {
    Mesh mesh = good;
    for (Vec3& vertex : mesh.vertices) vertex *= scale;
    mesh.vertices[2].y() += y;
    return mesh;
  };
  for (const auto& [mesh, why] : std::vector<std::pair<Mesh, const char*>>{
           {{}, "no vertices"},
           {{good.vertices, {}}, "no faces"},
           {{good.vertices, {{0, 0, 1}, {2, 2, 2}}}, "degenerate"},
           {placed(0, 0), "in one place"},
           {{good.vertices, {{0, 1, 2}, {0, 1, 4}}}, "face 1 (0-based) refers to vertex 4"},
           {{good.vertices, {{0, 1, -1}}}, "face 0 (0-based) refers to vertex -1"},
           {placed(1, kNan), "point 2 (0-based)"},
           {placed(1, kInfinity), "point 2 (0-based)"},
           {placed(1e-170, 0), "scale the shape"},
           {placed(1e-60, 0), "scale the shape"},
           {placed(1e60, 0), "scale the shape"},
           {placed(1e300, 0), "scale the shape"}})
    EXPECT_THAT([&mesh = mesh] { check_mesh(mesh); }, Refuses(why));
}

}  // namespace
}  // namespace salbench
