// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/gaze/hits.h"

#include "stages/core/rng.h"
#include "tests/support/rays.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

std::vector<GazeRay> rays_at(const Vec3& centre, double from, double beside, int count) {
  Rng rng(7, "rays", "item");
  std::vector<GazeRay> rays;
  for (int i = 0; i < count; ++i) {
    const auto anywhere = [&] { return Vec3(rng.normal(), rng.normal(), rng.normal()); };
    const Vec3 origin = centre + from * anywhere().normalized(), at = centre + beside * anywhere();
    rays.push_back({origin, (at - origin).normalized()});
  }
  return rays;
}

TEST(GazeHits, AreTheFacesThatEveryFaceLookedAtGives) {
  Mesh mesh = shapes::sphere(0);
  for (Vec3& v : mesh.vertices) v += Vec3(30, -4, 2);
  for (const double from : {2.0, 40.0, 1e5}) {  // radii: a near eye, and one too far for float
    const auto rays = rays_at({30, -4, 2}, from, 0.5, 2000);
    const auto hits = gaze_hits(mesh, rays);
    int met = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const double ahead = from - 2;
      FirstHit expected = met_by(mesh, rays[i].origin + ahead * rays[i].direction, rays[i].direction);
      expected.depth += ahead;
      ASSERT_EQ(hits[i].face, expected.face) << i << " from " << from;
      if (!expected) continue;
      ++met;
      EXPECT_NEAR(hits[i].depth, expected.depth, 1e-9 * from);
      EXPECT_LT((hits[i].point_in(mesh) - rays[i].origin - expected.depth * rays[i].direction).norm(),
                1e-9 * from);
    }
    EXPECT_GT(met, 1000);
    EXPECT_LT(met, 2000);
  }
}

TEST(GazeHits, ABackFaceHidesWhatIsBehindIt) {
  const Mesh mesh = shapes::joined(shapes::grid(1), shapes::grid(1), {0, 0, -1});
  const auto hits =
      gaze_hits(mesh, std::vector<GazeRay>{{{0.6, 0.3, -3}, {0, 0, 1}}, {{0.6, 0.3, 3}, {0, 0, -1}}});
  EXPECT_GE(hits[0].face, 2U) << "seen from below: the lower sheet, from its back";
  EXPECT_LT(hits[1].face, 2U);
}

TEST(GazeHits, ARayThatMissesByLittleTakesTheNearestDirectionThatMeetsTheShape) {
  const Mesh mesh = shapes::sphere(1);
  const auto rays = rays_at({0, 0, 0}, 4, 0.8, 120);
  const auto direct = gaze_hits(mesh, rays), near = gaze_hits(mesh, rays, {.snap = 2});
  int snapped = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (direct[i]) {
      EXPECT_EQ(near[i].face, direct[i].face);
      continue;
    }
    // No direction at a smaller angle meets it: tests some around the ray, at angles up to .05 degree less.
    const auto& [origin, direction] = rays[i];
    const Vec3 side = direction.unitOrthogonal(), up = direction.cross(side);
    const auto meets = [&](double degrees) {
      for (int k = 0; k < 120; ++k) {
        const double turn = k * 3 * kRadiansPerDegree, angle = degrees * kRadiansPerDegree;
        const Vec3 ahead =
            std::cos(angle) * direction + std::sin(angle) * (std::cos(turn) * side + std::sin(turn) * up);
        if (met_by(mesh, origin, ahead)) return true;
      }
      return false;
    };
    EXPECT_EQ(near[i].snapped, bool(near[i]));
    if (!near[i]) {
      EXPECT_FALSE(meets(1.95));
      continue;
    }
    ++snapped;
    const Vec3 to = (near[i].point_in(mesh) - origin).normalized();
    const double off = std::atan2(to.cross(direction).norm(), to.dot(direction)) / kRadiansPerDegree;
    EXPECT_LE(off, 2);
    EXPECT_TRUE(off < 0.05 || !meets(off - 0.05));
    EXPECT_TRUE(meets(off + 0.05));
    EXPECT_NEAR(near[i].depth, (near[i].point_in(mesh) - origin).norm(), 1e-12);
  }
  EXPECT_GT(snapped, 5);
}

TEST(GazeHits, RaysThatAreNoneAreNamed) {
  const Mesh mesh = shapes::tetrahedron();
  const GazeRay sound{{0, 0, 9}, {0, 0, -1}};
  for (const GazeRay& bad :
       {GazeRay{{0, 0, 9}, {0, 0, 0}}, GazeRay{{0, kNan, 9}, {0, 0, -1}}, GazeRay{{0, 0, 9}, {0, kNan, 0}}}) {
    const std::vector rays = {sound, bad};
    EXPECT_THAT([&] { gaze_hits(mesh, rays); }, Refuses("ray 2: "));
  }
  EXPECT_THROW(gaze_hits({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}}, std::vector{sound}), InputError);
  EXPECT_THAT(gaze_hits(mesh, {}), IsEmpty());
}

}  // namespace
}  // namespace salbench
