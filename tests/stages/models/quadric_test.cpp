// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/quadric.h"

#include "stages/core/rng.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

Vec3 random_vector(Rng& rng) {
  return Vec3(rng.uniform(), rng.uniform(), rng.uniform()) - Vec3::Constant(0.5);
}

// Planes around one point, whose normals differ by about `spread`.
Quadric bent_surface(Rng& rng, double spread) {
  const Vec3 normal = random_vector(rng).normalized(), point = random_vector(rng);
  Quadric quadric;
  for (int plane = 0; plane < 8; ++plane)
    quadric.add_plane((normal + spread * random_vector(rng)).normalized(), point + 0.01 * random_vector(rng),
                      rng.uniform());
  return quadric;
}

TEST(Quadric, TheBoundIsALittleLessThanTheLeastError) {
  Rng rng(7, "quadric", "");
  std::size_t bounds = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Quadric quadric = bent_surface(rng, std::pow(10, -2.5 * rng.uniform()));
    const Vec3 near = random_vector(rng);
    const auto bound = error_bound(quadric, near);
    if (!bound) continue;
    ++bounds;
    const double least = quadric(optimum(quadric, near));
    ASSERT_LE(*bound, least);
    ASSERT_NEAR(*bound, least, 1e-12);
  }
  EXPECT_GT(bounds, 10'000U);
}

TEST(Quadric, HasNoBoundWhereADirectionIsFree) {
  Quadric plane, edge;
  plane.add_plane(Vec3::UnitZ(), Vec3(0, 0, 1), 2);
  edge = plane;
  edge.add_plane(Vec3::UnitX(), Vec3(3, 0, 0), 1);
  EXPECT_FALSE(error_bound(plane, Vec3::Zero()));
  EXPECT_FALSE(error_bound(edge, Vec3::Zero()));
  EXPECT_FALSE(error_bound(Quadric(), Vec3::Zero()));
  EXPECT_TRUE(optimum(edge, Vec3(9, 5, 9)).isApprox(Vec3(3, 5, 1)));
}

}  // namespace
}  // namespace salbench
