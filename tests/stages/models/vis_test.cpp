// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/vis.h"

#include "tests/stages/models/surfaces.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

using testing::Le;

double mean_difference(const ScalarField& a, const ScalarField& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return sum / static_cast<double>(a.size());
}

// For a shape around the origin.
Normals directions_of(const std::vector<Vec3>& points) {
  Normals normals;
  for (const Vec3& p : points) normals.push_back(p.normalized());
  return normals;
}

Mesh cube() {
  Mesh mesh = shapes::box();
  for (Vec3& v : mesh.vertices) v -= Vec3::Constant(0.5);
  return mesh;
}

TEST(Vis, OfAConvexShapeIsWhole) {
  for (const Mesh& mesh : {shapes::sphere(4), cube(), shapes::tetrahedron()})
    EXPECT_THAT(vis_saliency(mesh.vertices, directions_of(mesh.vertices), mesh.faces, {}), Each(1));
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
  EXPECT_LT(mean_difference(vis_saliency(mesh.vertices, normals, mesh.faces, {}),
                            vis_saliency(mesh.vertices, normals, {}, {})),
            0.01);
}

TEST(Vis, ALargeShapeTakesTheValuesOfAnEvenSample) {
  const Mesh mesh = shapes::sphere_with_bump(5, -0.5, 0.4);
  const Normals normals = directions_of(mesh.vertices);
  const ScalarField all = vis_saliency(mesh.vertices, normals, mesh.faces, {}),
                    some = vis_saliency(mesh.vertices, normals, mesh.faces, {.sample = 4000});
  EXPECT_NE(all, some);
  EXPECT_LT(mean_difference(all, some), 0.01);
}

TEST(VisDegenerate, CoincidentPointsWithoutASurfaceHideNothing) {
  std::vector<Vec3> points(20, Vec3::Zero());
  points.emplace_back(0, 0, -1);
  EXPECT_THAT(vis_saliency(points, Normals(21, Vec3::UnitZ()), {}, {.directions = 16}), Each(Le(1)));
}

}  // namespace
}  // namespace salbench
