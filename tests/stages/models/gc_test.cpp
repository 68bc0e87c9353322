// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/gc.h"

#include <numbers>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/shapes.h"

namespace salbench {
namespace {

ScalarField curvature_of(const Mesh& mesh) { return gc_saliency(mesh.vertices, mesh.faces, {}); }

TEST(Gc, OfAPlaneIsZeroInsideAndAtItsEnd) {
  EXPECT_THAT(curvature_of(shapes::grid(8)), testing::Each(testing::DoubleNear(0, 1e-12)));
}

// Gauss and Bonnet: 2 pi times the Euler characteristic.
TEST(Gc, OfAConvexShapeSumsToTwoFullTurns) {
  const ScalarField curvature = curvature_of(shapes::sphere(3));
  EXPECT_NEAR(std::accumulate(curvature.begin(), curvature.end(), 0.0), 4 * std::numbers::pi, 1e-9);
}

TEST(Gc, OfARegularTetrahedronIsHalfATurnAtEachCorner) {
  const std::vector<Vec3> corners = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  const std::vector<Triangle> faces = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  EXPECT_THAT(curvature_of({corners, faces}), testing::Each(testing::DoubleNear(std::numbers::pi, 1e-12)));
}

TEST(Gc, OfAPointWithoutFacesIsZero) {
  EXPECT_THAT(gc_saliency(shapes::random_cloud(9, 1), {}, {}), testing::Each(0));
}

}  // namespace
}  // namespace salbench

// Golden rows of GC:
// protocol,stage,version,shape,array,options,count,finite,mean,sd,weighted_mean
// published,map.GC,1,cloud,saliency,e5189a95,642,642,0.1122913727,0.1257883193,0.1113232696
// published,map.GC,1,mesh,saliency,e5189a95,3204,3204,0.02710367173,0.03319655899,0.02707993018
// published,map.GC,1,scan,saliency,e5189a95,8597,8597,0.05087072146,0.06838612813,0.05025878475
// text,map.GC,1,cloud,saliency,e5189a95,642,642,0.1069417517,0.1207884158,0.1039263425
// text,map.GC,1,mesh,saliency,e5189a95,3204,3204,0.02710367173,0.03319655899,0.02707993018
// text,map.GC,1,scan,saliency,e5189a95,8597,8597,0.05092929682,0.06936899877,0.0502444117
