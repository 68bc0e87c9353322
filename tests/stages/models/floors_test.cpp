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
