// SPDX-License-Identifier: GPL-3.0-or-later

#include "stages/geometry/mesh_ops.h"
#include "stages/metrics/score.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

double cc_area(const ScalarField& map, const GroundTruth& truth, const ScalarField& areas) {
  const MetricsOptions options{.names = {"cc_area"}};
  return score(chosen_metrics(options), map, truth, options, Rng(1, "scores", "x"),
               {.size = map.size(), .areas = areas})
      .values[0];
}

TEST(ByArea, APointOfTwiceTheAreaIsTwoPoints) {
  EXPECT_NEAR(cc_area({0, 1, 3}, {{0, 2, 1}, {}}, {2, 1, 1}),
              cc(ScalarField{0, 0, 1, 3}, ScalarField{0, 0, 2, 1}), 1e-12);
}

TEST(ByArea, BarycentricAreasSumToTheSurface) {
  const Mesh mesh = shapes::bumpy_sphere(2);
  const ScalarField areas = barycentric_areas(mesh.vertices, mesh.faces);
  EXPECT_NEAR(std::accumulate(areas.begin(), areas.end(), 0.0), surface_area(mesh), 1e-12);
  const ScalarField corner =
      barycentric_areas(std::vector<Vec3>{{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {9, 9, 9}}, Faces{{0, 1, 2}});
  EXPECT_EQ(corner, (ScalarField{1, 1, 1, 0}));
}

TEST(ByArea, IsUndefinedWithoutAreas) {
  for (const ScalarField& areas : {ScalarField{}, ScalarField(3, 0.0)})
    EXPECT_TRUE(std::isnan(cc_area({1, 5, 2}, {{1, 3, 2}, {{1}}}, areas)));
}

}  // namespace
}  // namespace salbench
