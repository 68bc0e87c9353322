// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/surface_distances.h"

#include "stages/geometry/first_hit.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(SurfaceDistances, OnAPlaneAreStraight) {
  const Mesh mesh = shapes::grid(40);
  constexpr double kReach = 0.40001;  // between two points, regardless of rounding
  SurfaceDistances distances(mesh.vertices, mesh.faces);
  for (const Vec3& weights : {Vec3(0.2, 0.3, 0.5), Vec3(1, 0, 0), Vec3(0.5, 0.5, 0)}) {
    const std::uint32_t face = 1640;
    const Vec3 place = FirstHit{face, weights, 0}.point_in(mesh);
    const auto reached = distances.from(face, weights, kReach);
    std::size_t within = 0;
    for (const Vec3& p : mesh.vertices) within += (p - place).norm() <= kReach;
    EXPECT_EQ(reached.size(), within);
    for (const auto& [v, distance] : reached)
      EXPECT_NEAR(distance, (mesh.vertices[index(v)] - place).norm(), 1e-12);
    EXPECT_TRUE(std::ranges::is_sorted(reached,
                                       [](const auto& a, const auto& b) { return a.distance < b.distance; }));
  }
}

TEST(SurfaceDistances, OnASphereAreThoseOfGreatCircles) {
  const Mesh mesh = shapes::sphere(5);
  SurfaceDistances distances(mesh.vertices, mesh.faces);
  const Vec3 weights(0.2, 0.3, 0.5);
  const Vec3 place = FirstHit{3000, weights, 0}.point_in(mesh).normalized();
  double worst = 0;
  const auto reached = distances.from(3000, weights, 4);
  EXPECT_EQ(reached.size(), mesh.vertices.size());
  for (const auto& [v, distance] : reached) {
    const double angle = std::acos(std::clamp(mesh.vertices[index(v)].dot(place), -1.0, 1.0));
    if (angle < 2.5) worst = std::max(worst, std::abs(distance - angle));
  }
  EXPECT_LT(worst, 0.01);
}

}  // namespace
}  // namespace salbench
