// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/mesh_ops.h"

#include "stages/core/rng.h"
#include "stages/geometry/point_cloud.h"
#include "stages/geometry/support.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(MeshOps, SphereHasTheAreaAndRadiusOfASphere) {
  const Mesh mesh = shapes::sphere(4);
  EXPECT_NEAR(surface_area(mesh), 4 * std::numbers::pi, 0.02);
  EXPECT_NEAR(bounding_radius(mesh.vertices), 1, 1e-9);
  EXPECT_NEAR(area_centroid(mesh).norm(), 0, 1e-9);
}

TEST(MeshOps, AreaCentroidIgnoresVertexDensity) {
  Mesh mesh = shapes::grid(4);
  for (int i = 0; i < 100; ++i) mesh.vertices.emplace_back(9, 9, 9);  // isolated vertices carry no area
  EXPECT_TRUE(area_centroid(mesh).isApprox(Vec3(0.5, 0.5, 0)));
}

// Clouds of 9 to 24 points: with duplicates, with neighbours in floating point, or all in one place; up to
// 1e8 from the origin, with extents from far below the rounding there to large.
std::vector<Vec3> random_cloud(Rng& rng) {
  const auto direction = [&] { return Vec3(rng.normal(), rng.normal(), rng.normal()).normalized(); };
  const double offset = rng.below(4) == 0 ? 0 : std::pow(10, 8 - 12 * rng.uniform());
  const double extent = std::pow(10, 3 - 13 * rng.uniform());
  const Vec3 centre = offset * direction();
  std::vector<Vec3> points;
  const std::size_t n = 9 + rng.below(16), places = rng.below(3) == 0 ? 1 : 1 + rng.below(n);
  while (points.size() < places) points.push_back(centre + extent * rng.uniform() * direction());
  while (points.size() < n) {
    Vec3 again = points[rng.below(points.size())];
    if (places > 1 && rng.below(2) == 0) again.x() = std::nextafter(again.x(), 1e9);
    points.push_back(again);
  }
  return points;
}

TEST(Extent, OfRandomCloudsIsJudgedAlikeBeforeAndAfterTheScaling) {
  Rng rng(1, "extent", "");
  int in_one_place = 0, nearby = 0;
  for (int round = 0; round < 10000; ++round) {
    const std::vector<Vec3> points = random_cloud(rng);
    const bool no_extent = std::ranges::all_of(points, [&](const Vec3& p) {
      return p.x() == points[0].x() && p.y() == points[0].y() && p.z() == points[0].z();
    });
    ASSERT_EQ(coincide(points), no_extent) << round;
    ASSERT_EQ(bounding_radius(points) == 0, no_extent) << round;
    ASSERT_EQ(wrong_with_extent(points), no_extent ? "all points are in one place" : "") << round;
    ASSERT_EQ(grown_support_radius(points, 0.1).radius == 0, no_extent) << round;
    if (no_extent) {
      ASSERT_THROW(in_units_of_radius(points), InputError) << round;
      ASSERT_THROW(check_cloud({.points = points}), InputError) << round;
      ++in_one_place;
      continue;
    }
    ASSERT_NO_THROW(check_cloud({.points = points})) << round;
    const std::vector<Vec3> scaled = in_units_of_radius(points);
    EXPECT_FALSE(coincide(scaled));
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        if (points[i] == points[j]) {
          ASSERT_EQ(scaled[i], scaled[j]) << round;
        } else if ((points[i] - points[j]).norm() > 1e-15 * bounding_radius(points)) {
          ASSERT_NE(scaled[i], scaled[j]) << round;
          ++nearby;
        }
      }
  }
  EXPECT_GT(in_one_place, 2000);
  EXPECT_GT(nearby, 100000);
}

TEST(Extent, IsRefusedWhereItIsTooSmallOrTooLarge) {
  const auto wrong = [](const Vec3& second) { return wrong_with_extent(std::vector{Vec3(0, 0, 0), second}); };
  EXPECT_EQ(wrong({1e-50, 1e-300, 0}), "");
  EXPECT_THAT(wrong({1e-60, 0, 0}), HasSubstr("1e-60"));
  EXPECT_THAT(wrong({0, 1e60, 0}), HasSubstr("point 1 "));
  EXPECT_EQ(bounding_radius(std::vector<Vec3>(1000, Vec3(0.1, 0.7, 1e8 / 3))), 0);
}

TEST(MeshOps, AdjacencyIsSortedDistinctAndSymmetric) {
  const Mesh mesh = shapes::sphere(2);
  const Adjacency adjacency = edge_adjacency(mesh.vertices.size(), mesh.faces);
  EXPECT_EQ(adjacency.neighbours.size(), mesh.faces.size() * 3);  // closed: each edge in two faces
  for (std::size_t i = 0; i < adjacency.size(); ++i) {
    const auto row = adjacency.of(i);
    EXPECT_TRUE(std::ranges::is_sorted(row));
    for (const std::int32_t j : row)
      EXPECT_THAT(adjacency.of(index(j)), Contains(static_cast<std::int32_t>(i)));
  }
}

TEST(MeshOps, ComponentsAreNumberedByTheirLowestPoint) {
  const std::vector<Triangle> faces = {{4, 5, 6}, {0, 2, 3}};
  EXPECT_THAT(connected_components(edge_adjacency(7, faces)), ElementsAre(0, 1, 0, 0, 2, 2, 2));
}

TEST(EdgeDistances, FollowEdgesAndStopAtTheReach) {
  const Mesh mesh = shapes::grid(10);
  const Adjacency adjacency = edge_adjacency(mesh.vertices.size(), mesh.faces);
  EdgeDistances distances(mesh.vertices, adjacency);
  for (int repeat = 0; repeat < 2; ++repeat) {  // the workspace must be reset between calls
    const auto reached = distances.from(0, 0.15);
    ASSERT_EQ(reached.size(), 4U);  // itself, two sides of a cell and its diagonal
    EXPECT_EQ(reached[0].index, 0);
    EXPECT_NEAR(reached[1].distance, 0.1, 1e-12);
    EXPECT_NEAR(reached[3].distance, std::sqrt(0.02), 1e-12);
  }
  const double side = distances.from(0, 0.15)[1].distance;
  EXPECT_EQ(distances.from(0, side).size(), 3U);  // points at the reach count

  // Diagonals run along (1, 1) only: the shortest path uses as many as possible.
  const auto everything = distances.from(0, 10);
  ASSERT_EQ(everything.size(), mesh.vertices.size());
  for (const auto& [index, distance] : everything) {
    const auto [near, far] =
        std::minmax({mesh.vertices[std::size_t(index)].x(), mesh.vertices[std::size_t(index)].y()});
    EXPECT_NEAR(distance, far - near + std::sqrt(2) * near, 1e-12);
  }
  EXPECT_TRUE(
      std::ranges::is_sorted(everything, {}, [](const auto& r) { return std::pair(r.distance, r.index); }));
}

}  // namespace
}  // namespace salbench
