// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/floors.h"

#include "stages/geometry/mesh_ops.h"
#include "stages/geometry/support.h"
#include "stages/models/curvature.h"
#include "stages/normals/normals.h"
#include "tests/stages/models/surfaces.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

using testing::DoubleEq;

TEST(Cb, IsTheDistanceFromTheCentroidInUnitsOfTheLargest) {
  EXPECT_THAT(cb_saliency(std::vector<Vec3>{{3, 0, 0}, {-1, 0, 0}, {-2, 0, 0}}, {}),
              ElementsAre(1, DoubleNear(1.0 / 3, 1e-15), DoubleNear(2.0 / 3, 1e-15)));
}

ScalarField nv(const Mesh& mesh, const NvOptions& options = {}) {
  return nv_saliency(mesh.vertices, mesh_normals(mesh), options);
}

// One minus the mean dot product, every point against every other.
ScalarField variation_written_out(const Mesh& mesh, const NvOptions& options) {
  const Normals normals = mesh_normals(mesh);
  const double radius = grown_support_radius(mesh.vertices, options.radius).radius;
  ScalarField variation;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    double dots = 0, count = 0;
    for (std::size_t j = 0; j < normals.size(); ++j)
      if (i != j && (mesh.vertices[i] - mesh.vertices[j]).norm() <= radius) {
        dots += normals[i].dot(normals[j]);
        ++count;
      }
    variation.push_back(count > 0 ? 1 - dots / count : 0);
  }
  return variation;
}

TEST(Nv, EqualsTheFormulaWrittenOut) {
  const Mesh mesh = shapes::bumpy_sphere(3);
  for (const double radius : {0.02, 0.3, 3.0})
    EXPECT_THAT(nv(mesh, {.radius = radius}),
                Pointwise(DoubleNear(1e-12), variation_written_out(mesh, {.radius = radius})));
}

TEST(Nv, OfAPointOutOfReachIsZero) {
  std::vector<Vec3> points;
  Normals normals;
  for (int i = 0; i < 40; ++i) {
    points.emplace_back(i * 1e-3, 0, 0);
    normals.push_back(i % 2 == 0 ? Vec3::UnitZ() : Vec3::UnitX());
  }
  points.emplace_back(100, 0, 0);
  normals.push_back(Vec3::UnitY());
  const ScalarField variation = nv_saliency(points, normals, {});
  EXPECT_EQ(variation.back(), 0);
  EXPECT_GT(variation.front(), 0.4);
}

TEST(Mc, IsTheMagnitudeOfTheMeanCurvatureInUnitsOfTheRadius) {
  const Mesh mesh = shapes::moved(shapes::bumpy_sphere(3), 40);
  const double radius = bounding_radius(mesh.vertices);
  for (const CurvatureMethod method : {CurvatureMethod::cotangent, CurvatureMethod::taubin}) {
    ScalarField expected = mean_curvature(mesh.vertices, mesh.faces, method);
    ASSERT_LT(std::ranges::min(expected), 0) << "a surface that is hollow somewhere";
    for (double& value : expected) value = std::abs(value) * radius;
    EXPECT_THAT(mc_saliency(mesh.vertices, mesh.faces, {.curvature = method}),
                Pointwise(DoubleNear(1e-9), expected));
  }
}

TEST(Vd, OfAnOpenFanAndAnIsolatedPoint) {
  const std::vector<Vec3> points(5, Vec3::Zero());  // independent of coordinates
  const Faces faces = {{0, 1, 2}, {0, 2, 3}};
  EXPECT_THAT(vd_saliency(points, faces, {}), ElementsAre(3, 2, 3, 2, 0));
  EXPECT_THAT(vd_saliency(points, {}, {}), Each(0));
}

ScalarField sd(const Mesh& mesh) { return sd_saliency(mesh.vertices, mesh.faces, {}); }

double radius_squared(const std::vector<Vec3>& points) { return std::pow(bounding_radius(points), 2); }

TEST(Sd, OfAMeshIsOneOverAThirdOfTheFacesAround) {
  const Mesh mesh = {{{0, 0, 0}, {4, 0, 0}, {0, 3, 0}, {0, 0, 3}, {9, 9, 9}}, {{0, 1, 2}, {0, 3, 1}}};
  const double unit = radius_squared(mesh.vertices) / 2;  // a third of a face has the area 2
  const ScalarField density = sd(mesh);
  EXPECT_THAT(density,
              ElementsAre(DoubleEq(unit / 2), DoubleEq(unit / 2), DoubleEq(unit), DoubleEq(unit), 0));
  EXPECT_THAT(sd_saliency(mesh.vertices, {}, {}), Each(0));
}

// k others in the disc that reaches to the k-th of them, in units of R.
TEST(Sd, OfPointsIsThatOfTheDiscOfTheNearest) {
  const std::vector<Vec3> two = {{0, 0, 0}, {2, 0, 0}}, row = {{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {8, 0, 0}};
  EXPECT_THAT(sd_saliency_of_points(two, {}), Each(DoubleEq(1 / (4 * std::numbers::pi))));
  const double unit = radius_squared(row) * 2 / std::numbers::pi;
  EXPECT_THAT(sd_saliency_of_points(row, {.neighbours = 2}),
              ElementsAre(DoubleEq(unit / 9), DoubleEq(unit / 4), DoubleEq(unit / 9), DoubleEq(unit / 49)));
}

TEST(SdDegenerate, PointsInOnePlaceAreAsDenseAsTheDensestOther) {
  const std::vector<Vec3> points = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {3, 0, 0}};
  const ScalarField density = sd_saliency_of_points(points, {.neighbours = 2});
  EXPECT_GT(density[3], density[4]);
  EXPECT_THAT((std::vector<double>{density[0], density[1], density[2]}), Each(density[3]));
  const std::vector<Vec3> pairs = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0, 0}};
  EXPECT_THAT(sd_saliency_of_points(pairs, {.neighbours = 1}), Each(0));
}

TEST(SdDegenerate, PointsWithoutExtent) {
  const std::vector<Vec3> one = {{1, 2, 3}}, far = {{0, 0, 0}, {1, 0, kInfinity}};
  for (const std::vector<Vec3>& points : {std::vector<Vec3>{}, one, std::vector<Vec3>{one[0], one[0]}, far})
    EXPECT_THROW(sd_saliency_of_points(points, {}), InputError);
}

}  // namespace
}  // namespace salbench

// Golden rows of CB, MC, NV, SD, VD:
// protocol,stage,version,shape,array,options,count,finite,mean,sd,weighted_mean
// published,map.CB,1,cloud,saliency,e5189a95,642,642,0.809960005,0.07122779822,0.8115140391
// published,map.CB,1,mesh,saliency,e5189a95,3204,3204,0.7928036988,0.08196116096,0.7935043382
// published,map.CB,1,scan,saliency,e5189a95,8597,8597,0.5361398407,0.1776507854,0.5362179703
// published,map.MC,1,cloud,saliency,c464b19f,642,642,2.816425918,2.693609795,2.76150239
// published,map.MC,1,mesh,saliency,c464b19f,3204,3204,1.782233226,1.305538149,1.773390071
// published,map.MC,1,scan,saliency,c464b19f,8597,8597,3.587650723,3.851420666,3.579687245
// published,map.NV,1,cloud,saliency,700d376a,642,642,0.03369587549,0.02197589404,0.03398184627
// published,map.NV,1,mesh,saliency,700d376a,3204,3204,0.02442733031,0.02045353341,0.02435000278
// published,map.NV,1,scan,saliency,700d376a,8597,8597,0.0200209834,0.01609757759,0.01999534739
// published,map.SD,1,cloud,saliency,cd7b6cd8,642,642,75.73783114,9.680367856,75.58470405
// published,map.SD,1,mesh,saliency,cd7b6cd8,3204,3204,251.9798512,110.3327234,251.1832975
// published,map.SD,1,scan,saliency,cd7b6cd8,8597,8597,141.462331,60.15440801,141.2443309
// published,map.VD,1,cloud,saliency,e5189a95,642,642,5.981308411,3.336706012,6.00828265
// published,map.VD,1,mesh,saliency,e5189a95,3204,3204,5.992509363,0.08622370362,5.992871726
// published,map.VD,1,scan,saliency,e5189a95,8597,8597,5.665929976,2.55834672,5.638876251
// text,map.MC,1,cloud,saliency,c464b19f,642,642,2.711504539,2.477804869,2.66171972
// text,map.MC,1,scan,saliency,c464b19f,8597,8597,3.58083482,3.865621234,3.57667614
// text,map.NV,1,cloud,saliency,700d376a,642,642,0.04974836453,0.03184472275,0.05040437674
// text,map.NV,1,mesh,saliency,700d376a,3204,3204,0.02483252667,0.02045474286,0.02474140386
// text,map.NV,1,scan,saliency,700d376a,8597,8597,0.02564940949,0.02069659807,0.02553387804
// text,map.VD,1,cloud,saliency,e5189a95,642,642,5.971962617,3.210549037,5.956042508
// text,map.VD,1,scan,saliency,e5189a95,8597,8597,5.666627893,2.569462027,5.641123058
