// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/picture/occlusion.h"

#include "tests/support/test.h"

namespace salbench {
namespace {

const Rng kRng(1, "occlusion", "");

// A surface point that faces the camera.
Site site_at(const Vec3f& position) {
  const Vec3f normal(0, 0, -1);
  return {true, position, normal, normal};
}

// Two faces across the whole view.
embree::Scene wall(const std::array<Vec3, 4>& corners) {
  return embree::scene_of_triangles(corners, std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}});
}

PictureOptions rays(std::int32_t samples) { return {.occlusion_samples = samples, .occlusion_reach = 1e3}; }

// A disc of radius r at the distance h above a place hides r^2 / (r^2 + h^2) of its sky.
TEST(Openness, BelowADiscIsItsFormFactor) {
  const std::vector<Site> sites(16, site_at({0, 0, 5}));
  for (const double radius : {0.5, 1.0, 2.0}) {
    const std::vector<Vec3> centre = {{0, 0, 4}}, normal = {{0, 0, -1}};
    const embree::Scene disc = embree::scene_of_discs(centre, normal, std::vector<double>{radius});
    const float expected = 1 - static_cast<float>(radius * radius / (radius * radius + 1));
    EXPECT_THAT(openness(disc, sites, {4, 0.3}, rays(64), kRng), Each(testing::FloatNear(expected, 0.01F)));
  }
}

TEST(Openness, IsNotSharedBetweenSurfacesAtDifferentDepths) {
  constexpr int kSide = 8;
  std::vector<Site> sites;
  for (int i = 0; i < kSide * kSide; ++i) sites.push_back(site_at({0, 0, i % kSide < 4 ? 5.0F : 6.0F}));
  const embree::Scene between = wall({Vec3(-99, -99, 5.5), {99, -99, 5.5}, {99, 99, 5.5}, {-99, 99, 5.5}});
  const std::vector<float> open = openness(between, sites, {kSide, 0.2}, rays(4), kRng);
  for (int i = 0; i < kSide * kSide; ++i) EXPECT_EQ(open[index(i)], i % kSide < 4 ? 1 : 0) << i;
}

// One ray each for two adjacent pixels, which are otherwise unrelated: their hits on a wall beside them agree
// about as often as by chance.
TEST(Openness, DirectionsOfPixelsSideBySideAreUnrelated) {
  const embree::Scene beside =
      wall({Vec3(0.001, -999, -999), {0.001, 999, -999}, {0.001, 999, 999}, {0.001, -999, 999}});
  std::vector<Site> sites(16);
  sites[0] = site_at({0, 0, 5});
  sites[1] = site_at({0, 0, 50});
  int open = 0, alike = 0;
  constexpr int kRounds = 1000;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<float> found =
        openness(beside, sites, {4, 0.3}, rays(1), Rng(static_cast<std::uint64_t>(round), "rounds", ""));
    open += found[0] == 1 ? 1 : 0;
    alike += found[0] == found[1] ? 1 : 0;
  }
  EXPECT_NEAR(open, kRounds / 2.0, kRounds / 20.0);
  EXPECT_NEAR(alike, kRounds / 2.0, kRounds / 10.0);
}

}  // namespace
}  // namespace salbench
