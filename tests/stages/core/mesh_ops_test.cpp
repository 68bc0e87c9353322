// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/mesh_ops.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/shapes.h"

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

TEST(MeshOps, AdjacencyIsSortedDistinctAndSymmetric) {
  const Mesh mesh = shapes::sphere(2);
  const Adjacency adjacency = edge_adjacency(mesh.vertices.size(), mesh.faces);
  EXPECT_EQ(adjacency.neighbours.size(), mesh.faces.size() * 3);  // closed: each edge in two faces
  for (std::size_t i = 0; i < adjacency.size(); ++i) {
    const auto row = adjacency.of(i);
    EXPECT_TRUE(std::is_sorted(row.begin(), row.end()));
    for (const std::int32_t j : row)
      EXPECT_THAT(adjacency.of(static_cast<std::size_t>(j)), testing::Contains(static_cast<std::int32_t>(i)));
  }
}

TEST(MeshOps, ComponentsAreNumberedByTheirLowestPoint) {
  const std::vector<Triangle> faces = {{4, 5, 6}, {0, 2, 3}};
  EXPECT_THAT(connected_components(edge_adjacency(7, faces)), testing::ElementsAre(0, 1, 0, 0, 2, 2, 2));
}

TEST(EdgeDistances, FollowEdgesAndStopAtTheReach) {
  const Mesh mesh = shapes::grid(10);
  const Adjacency adjacency = edge_adjacency(mesh.vertices.size(), mesh.faces);
  EdgeDistances distances(mesh.vertices, adjacency);
  for (int repeat = 0; repeat < 2; ++repeat) {  // the workspace must come back clean
    const auto reached = distances.from(0, 0.15);
    ASSERT_EQ(reached.size(), 4U);  // itself, two sides of a cell and its diagonal
    EXPECT_EQ(reached[0].index, 0);
    EXPECT_NEAR(reached[1].distance, 0.1, 1e-12);
    EXPECT_NEAR(reached[3].distance, std::sqrt(0.02), 1e-12);
  }
  const double side = distances.from(0, 0.15)[1].distance;
  EXPECT_EQ(distances.from(0, side).size(), 3U);  // those at the reach count

  // Diagonals run along (1, 1) alone: the shortest path takes as many as it can.
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
