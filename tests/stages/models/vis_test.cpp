// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/vis.h"

#include "tests/stages/models/surfaces.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

using testing::Ge;
using testing::Le;

// For a shape around the origin.
Normals directions_of(const std::vector<Vec3>& points) {
  Normals normals;
  for (const Vec3& p : points) normals.push_back(p.normalized());
  return normals;
}

Mesh cube(double half) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back(half * ((i & 1) * 2 - 1), half * ((i & 2) - 1), half * ((i >> 1 & 2) - 1));
  mesh.faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

TEST(Vis, OfAConvexShapeIsWhole) {
  for (const Mesh& mesh : {shapes::sphere(4), cube(1), shapes::tetrahedron()})
    EXPECT_THAT(vis_saliency(mesh.vertices, directions_of(mesh.vertices), mesh.faces, {}), Each(1));
}

TEST(Vis, OfASphereWithoutFacesIsWhole) {
  const Mesh sphere = shapes::sphere(4);
  EXPECT_THAT(vis_saliency(sphere.vertices, directions_of(sphere.vertices), {}, {}), Each(1));
}

// At depth h below the rim of an open cylinder of radius 1, on its axis, the opening covers the fraction 1 -
// cos(atan(1 / h)) of the half space.
TEST(Vis, AtTheBottomOfAWellIsTheOpening) {
  for (const double depth : {0.5, 1.0, 2.0}) {
    Mesh well = shapes::cylinder(1, depth, 256, 3);
    well.vertices.emplace_back(0, 0, 0);
    Normals normals(well.vertices.size(), Vec3::UnitZ());
    const ScalarField found = vis_saliency(well.vertices, normals, well.faces, {.directions = 4096});
    EXPECT_NEAR(found.back(), 1 - std::cos(std::atan(1 / depth)), 0.003) << depth;
  }
}

TEST(Vis, PointsWithoutASurfaceHideEachOtherLikeOne) {
  const Mesh mesh = shapes::sphere_with_bump(5, -0.5, 0.2);
  const Normals normals = directions_of(mesh.vertices);
  const ScalarField surface = vis_saliency(mesh.vertices, normals, mesh.faces, {}),
                    discs = vis_saliency(mesh.vertices, normals, {}, {});
  double difference = 0;
  for (std::size_t i = 0; i < surface.size(); ++i)
    difference += std::abs(surface[i] - discs[i]) / static_cast<double>(surface.size());
  EXPECT_LT(difference, 0.01);
}

TEST(Vis, ALargeShapeTakesTheValuesOfAnEvenSample) {
  const Mesh mesh = shapes::sphere_with_bump(5, -0.5, 0.4);
  const Normals normals = directions_of(mesh.vertices);
  const ScalarField all = vis_saliency(mesh.vertices, normals, mesh.faces, {}),
                    some = vis_saliency(mesh.vertices, normals, mesh.faces, {.sample = 4000});
  EXPECT_NE(all, some);
  double difference = 0;
  for (std::size_t i = 0; i < all.size(); ++i)
    difference += std::abs(all[i] - some[i]) / static_cast<double>(all.size());
  EXPECT_LT(difference, 0.01);
  EXPECT_THAT(some, Each(AllOf(Ge(0), Le(1))));
}

TEST(VisDegenerate, CoincidentPointsWithoutASurfaceHideNothing) {
  std::vector<Vec3> points(20, Vec3::Zero());
  points.emplace_back(0, 0, -1);
  EXPECT_THAT(vis_saliency(points, Normals(21, Vec3::UnitZ()), {}, {.directions = 16}), Each(Le(1)));
}

}  // namespace
}  // namespace salbench

// Golden rows of VIS:
// protocol,stage,version,shape,array,options,count,finite,mean,sd,weighted_mean
// published,map.VIS,1,cloud,saliency,9e084467,642,642,0.9223860981,0.120280308,0.9219718917
// published,map.VIS,1,mesh,saliency,9e084467,3204,3204,0.9111876756,0.09835774833,0.9119354258
// published,map.VIS,1,scan,saliency,9e084467,8597,8597,0.9343730008,0.09104040301,0.9340322029
// text,map.VIS,1,cloud,saliency,9e084467,642,642,0.9176036799,0.1192435077,0.9187477748
// text,map.VIS,1,mesh,saliency,9e084467,3204,3204,0.9109267712,0.09884332685,0.9117081043
// text,map.VIS,1,scan,saliency,9e084467,8597,8597,0.9344457005,0.09433691803,0.934131402
