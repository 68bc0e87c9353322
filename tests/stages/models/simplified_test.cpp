// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/simplified.h"

#include "stages/geometry/mesh_ops.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

// Number of faces at each edge.
std::map<std::pair<std::int32_t, std::int32_t>, int> edge_uses(const Mesh& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> uses;
  for (const auto& [a, b, c] : mesh.faces)
    for (const auto& edge : {std::minmax(a, b), std::minmax(b, c), std::minmax(c, a)}) ++uses[edge];
  return uses;
}

int euler_characteristic(const Mesh& mesh) {
  return static_cast<int>(mesh.vertices.size()) - static_cast<int>(edge_uses(mesh).size()) +
         static_cast<int>(mesh.faces.size());
}

double volume(const Mesh& mesh) {
  double sum = 0;
  for (const Triangle& face : mesh.faces)
    sum += face_area_vector(mesh, face).dot(mesh.vertices[index(face[0])]) / 6;
  return sum;
}

std::int32_t component_count(const Mesh& mesh) {
  const auto labels = connected_components(edge_adjacency(mesh.vertices.size(), mesh.faces));
  return 1 + *std::ranges::max_element(labels);
}

TEST(Simplified, SphereStaysASphere) {
  const Mesh fine = shapes::sphere(4), coarse = simplified(fine, 1000);
  EXPECT_EQ(coarse.faces.size(), 1000U);
  EXPECT_EQ(coarse.vertices.size(), 502U);  // V = F / 2 + 2
  EXPECT_EQ(euler_characteristic(coarse), 2);
  for (const auto& [edge, uses] : edge_uses(coarse)) EXPECT_EQ(uses, 2);
  for (const Vec3& v : coarse.vertices) EXPECT_NEAR(v.norm(), 1, 0.01);
  EXPECT_NEAR(volume(coarse) / volume(fine), 1, 0.005);
}

TEST(Simplified, CubeOfManyFacesComesDownToItsCorners) {
  Mesh fine = shapes::box();
  for (int level = 0; level < 3; ++level) fine = shapes::split_in_four(fine);
  const Mesh coarse = simplified(fine, 12);
  EXPECT_EQ(coarse.vertices.size(), 8U);
  EXPECT_EQ(coarse.faces.size(), 12U);
  for (const Vec3& corner : shapes::box().vertices)
    EXPECT_TRUE(
        std::ranges::any_of(coarse.vertices, [&](const Vec3& v) { return (v - corner).norm() < 1e-6; }));
  EXPECT_NEAR(volume(coarse), 1, 1e-6);
}

TEST(Simplified, OpenSquareKeepsItsOutline) {
  const Mesh coarse = simplified(shapes::grid(20), 50);
  EXPECT_LE(coarse.faces.size(), 50U);
  EXPECT_EQ(euler_characteristic(coarse), 1);
  EXPECT_NEAR(surface_area(coarse), 1, 1e-6);
  for (const Vec3& v : coarse.vertices) EXPECT_NEAR(v.z(), 0, 1e-9);
  for (const Triangle& face : coarse.faces)
    EXPECT_GT(face_area_vector(coarse, face).z(), 0);  // none is inverted
}

// A border edge's plane is weighted by the square of its length, as a face by its area.
TEST(Simplified, ABorderGetsCoarserAsTheInteriorDoes) {
  const Mesh sphere = shapes::sphere(5);
  Mesh half{sphere.vertices, {}};
  for (const Triangle& face : sphere.faces) {
    double height = 0;
    for (const std::int32_t v : face) height += sphere.vertices[index(v)].z();
    if (height > 0) half.faces.push_back(face);
  }
  const Mesh coarse = simplified(half, 100);
  std::map<bool, std::pair<double, double>> lengths;  // [is at the border]: sum, count
  for (const auto& [edge, uses] : edge_uses(coarse)) {
    auto& [sum, count] = lengths[uses == 1];
    sum += (coarse.vertices[index(edge.first)] - coarse.vertices[index(edge.second)]).norm();
    ++count;
  }
  const auto mean = [&](bool border) { return lengths[border].first / lengths[border].second; };
  EXPECT_GT(mean(true), 0.5 * mean(false));
  EXPECT_LT(mean(true), 1.5 * mean(false));
}

TEST(Simplified, APointInsideJoinsTheBorderWhicheverOfThemComesFirst) {
  const std::vector<Vec3> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (const std::int32_t inside : {0, 1, 3}) {
    Mesh fan{corners, {}};
    fan.vertices.insert(fan.vertices.begin() + inside, Vec3(0.3, 0.3, 0));
    const auto corner = [&](std::int32_t k) { return k % 3 < inside ? k % 3 : k % 3 + 1; };
    for (std::int32_t k = 0; k < 3; ++k) fan.faces.push_back({corner(k), corner(k + 1), inside});
    const Mesh one = simplified(fan, 1);
    ASSERT_EQ(one.faces.size(), 1U) << inside;
    ASSERT_EQ(one.vertices.size(), 3U);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_LT((one.vertices[k] - corners[k]).norm(), 1e-6) << inside;
  }
}

TEST(Simplified, SmallMeshIsOnlyCleaned) {
  Mesh mesh = shapes::tetrahedron();
  mesh.vertices.insert(mesh.vertices.begin(), Vec3(9, 9, 9));  // unreferenced
  for (auto& [a, b, c] : mesh.faces) ++a, ++b, ++c;
  mesh.faces.push_back({2, 1, 3});  // the first face, inverted
  mesh.faces.push_back({2, 2, 3});  // degenerate
  const Mesh clean = simplified(mesh, 100);
  const Mesh expected = shapes::tetrahedron();
  EXPECT_EQ(clean.faces, expected.faces);
  ASSERT_EQ(clean.vertices.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_TRUE(clean.vertices[i].isApprox(expected.vertices[i], 1e-12));
}

// Each face of a fan occurs twice, from another corner and inverted: the first is kept, whichever corner's
// faces are searched.
TEST(Simplified, FacesAroundAHubStayOnce) {
  constexpr int kFaces = 500;
  Mesh fan{{{0, 0, 1}}, {}};
  for (int i = 0; i < kFaces; ++i) {
    const double angle = 2 * std::numbers::pi * i / kFaces;
    fan.vertices.emplace_back(std::cos(angle), std::sin(angle), 0);
    fan.faces.push_back({0, 1 + i, 1 + (i + 1) % kFaces});
  }
  Mesh doubled = fan;
  for (const auto& [hub, a, b] : fan.faces)
    doubled.faces.push_back(a % 2 == 0 ? Triangle{b, a, hub} : Triangle{a, b, hub});
  EXPECT_EQ(simplified(doubled, 1000).faces, fan.faces);
  const Mesh coarse = simplified(doubled, 40);
  EXPECT_EQ(coarse.faces.size(), 40U);
  EXPECT_EQ(coarse.vertices.size(), 41U);
  EXPECT_EQ(euler_characteristic(coarse), 1);
}

TEST(Simplified, StopsWhereOnlyCollapsesThatChangeTheTopologyAreLeft) {
  EXPECT_EQ(simplified(shapes::tetrahedron(), 1).faces.size(), 4U);
  const Mesh coarse = simplified(shapes::joined(shapes::sphere(2), shapes::sphere(1), {5, 0, 0}), 1);
  EXPECT_EQ(component_count(coarse), 2);
  EXPECT_EQ(euler_characteristic(coarse), 4);
}

TEST(Simplified, BookOfThreePagesKeepsItsSpine) {
  // Three half-planes that meet in a line: an edge with three faces is valid.
  Mesh book;
  const std::int32_t cells = 10;
  for (int page = 0; page < 3; ++page) {
    const double angle = 2 * std::numbers::pi * page / 3;
    const Mesh flat = shapes::grid(cells);
    std::vector<std::int32_t> index;
    for (const Vec3& v : flat.vertices) {
      const bool spine = v.x() == 0;
      if (spine && page > 0) {
        index.push_back(static_cast<std::int32_t>(std::lround(v.y() * cells)) * (cells + 1));
        continue;
      }
      index.push_back(static_cast<std::int32_t>(book.vertices.size()));
      book.vertices.emplace_back(v.x() * std::cos(angle), v.y(), v.x() * std::sin(angle));
    }
    for (const Triangle& face : flat.faces)
      book.faces.push_back({index[static_cast<std::size_t>(face[0])],
                            index[static_cast<std::size_t>(face[1])],
                            index[static_cast<std::size_t>(face[2])]});
  }
  const Mesh coarse = simplified(book, 60);
  EXPECT_LE(coarse.faces.size(), 60U);
  EXPECT_EQ(component_count(coarse), 1);
  EXPECT_NEAR(surface_area(coarse), 3, 1e-6);
  int spine = 0;
  for (const auto& [edge, uses] : edge_uses(coarse)) spine += uses == 3 ? 1 : 0;
  EXPECT_GE(spine, 1);
}

TEST(Simplified, SurfacesThatTouchInOnePointStayConnected) {
  // A chain: two discs connected by a single triangle between a point of each.
  Mesh chain = shapes::joined(shapes::grid(8), shapes::grid(8), {2, 0, 0});
  chain.vertices.emplace_back(1.5, -1, 0);
  const auto tip = static_cast<std::int32_t>(chain.vertices.size()) - 1;
  chain.faces.push_back({8, tip, 81});
  ASSERT_EQ(component_count(chain), 1);
  EXPECT_EQ(component_count(simplified(chain, 1)), 1);
}

TEST(Simplified, ScalesWithTheMesh) {
  // A power of two is exact: the same collapses in the same order.
  Mesh large = shapes::bumpy_sphere(3);
  const Mesh coarse = simplified(large, 300);
  for (Vec3& v : large.vertices) v *= 64;
  const Mesh coarse_large = simplified(large, 300);
  EXPECT_EQ(coarse.faces, coarse_large.faces);
  for (std::size_t i = 0; i < coarse.vertices.size(); ++i)
    EXPECT_TRUE(coarse_large.vertices[i].isApprox(64 * coarse.vertices[i], 1e-9));
}

TEST(Simplified, CoincidentVerticesAndFacesWithoutAreaDoNoHarm) {
  Mesh mesh = shapes::sphere(3);
  for (std::size_t i = 0; i < mesh.vertices.size(); i += 5) mesh.vertices[i] = mesh.vertices[i / 5 * 5 / 2];
  const Mesh coarse = simplified(mesh, 400);
  EXPECT_EQ(coarse.faces.size(), 400U);
  EXPECT_EQ(coarse.vertices.size(), 202U);  // V = F / 2 + 2: closed, without a handle
  for (const auto& [edge, uses] : edge_uses(coarse)) EXPECT_EQ(uses, 2);
  for (const Vec3& v : coarse.vertices) EXPECT_LT(v.norm(), 1.1);  // no optimum far from the surface
}

TEST(Simplified, NothingOfNothing) {
  EXPECT_TRUE(simplified(Mesh{}, 10).vertices.empty());
  EXPECT_TRUE(simplified(Mesh{{Vec3(1, 2, 3)}, {}}, 10).vertices.empty());
}

}  // namespace
}  // namespace salbench
