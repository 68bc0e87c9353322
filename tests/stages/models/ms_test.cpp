// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/ms.h"

#include <Eigen/Eigenvalues>

#include "stages/core/field.h"
#include "stages/geometry/mesh_ops.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

ScalarField ms(const Mesh& mesh, const MsOptions& options = {}) {
  return ms_saliency(mesh.vertices, mesh.faces, options);
}

// Distinct eigenvalues, unlike the fivefold ones of a sphere.
Mesh ellipsoid(int levels) {
  Mesh mesh = shapes::sphere(levels);
  for (Vec3& v : mesh.vertices) v = v.cwiseProduct(Vec3(1, 1.4, 2.3));
  return mesh;
}

double largest_difference(const ScalarField& a, const ScalarField& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b.at(i)));
  return largest;
}

// Brute-force reference for meshes that need no simplification: complete dense spectrum, all frequencies,
// explicit matrix B exp|g - A| B'.
ScalarField dense_saliency(const Mesh& mesh, MsWeight weight) {
  const auto n = static_cast<Eigen::Index>(mesh.vertices.size());
  const auto row = [](Eigen::Index i) { return static_cast<std::size_t>(i); };
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(n, n), edges = weights;
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(n);
  for (const Triangle& face : mesh.faces) {
    const double third = face_area_vector(mesh, face).norm() / 6;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Index i = face[k], j = face[(k + 1) % 3];
      edges(i, j) = edges(j, i) = 1;
      weights(i, j) = weights(j, i) = 1 / (mesh.vertices[row(i)] - mesh.vertices[row(j)]).squaredNorm();
      areas[i] += third;
    }
  }
  const Eigen::VectorXd degrees = weights.rowwise().sum();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(Eigen::MatrixXd(degrees.asDiagonal()) -
                                                              weights);
  Eigen::VectorXd values = solver.eigenvalues();
  values[0] = 1e-17 * 1.3 * degrees.maxCoeff();
  const Eigen::VectorXd logs = values.array().log();
  Eigen::VectorXd amplified(n);
  for (Eigen::Index f = 0; f < n; ++f) {
    double mean = 0;
    for (Eigen::Index k = f - 4; k <= f + 4; ++k) mean += logs[std::clamp<Eigen::Index>(k, 0, n - 1)] / 9;
    amplified[f] = std::exp(std::abs(logs[f] - mean));
  }
  const Eigen::MatrixXd spread =
      solver.eigenvectors() * amplified.asDiagonal() * solver.eigenvectors().transpose();
  Eigen::VectorXd saliency = spread.cwiseProduct(weight == MsWeight::area ? edges : weights).rowwise().sum();
  if (weight == MsWeight::area) saliency = saliency.cwiseQuotient(areas);

  const Eigen::MatrixXd ring = edges + Eigen::MatrixXd::Identity(n, n);
  for (int pass = 0; pass < 2; ++pass)  // on the simplified mesh and on the full one, which are the same here
    saliency = (ring * saliency).cwiseQuotient(ring.rowwise().sum()).eval();
  const Eigen::VectorXd result = saliency.array().log();
  return {result.data(), result.data() + n};
}

TEST(Ms, FewEigenpairsEqualTheWholeDecomposition) {
  for (const MsWeight weight : {MsWeight::area, MsWeight::inverse_square}) {
    for (const Mesh& mesh : {ellipsoid(3), shapes::bumpy_sphere(3)}) {
      const ScalarField few = min_max_normalised(ms(mesh, {.weight = weight}));
      const ScalarField all = min_max_normalised(dense_saliency(mesh, weight));
      EXPECT_LT(largest_difference(few, all), 1e-4) << name_of(weight);
    }
  }
}

TEST(Ms, DoesNotDependOnTheSizeHoweverSmallOrLarge) {
  const Mesh mesh = shapes::bumpy_sphere(3);
  const ScalarField expected = min_max_normalised(ms(mesh));
  for (const double size : {1e-49, 1e49}) {
    Mesh scaled = mesh;
    for (Vec3& v : scaled.vertices) v *= size;
    EXPECT_LT(largest_difference(min_max_normalised(ms(scaled)), expected), 1e-6) << size;
  }
}

TEST(Ms, LargestComponentDecidesAndTheOthersFollowIt) {
  const Mesh large = shapes::bumpy_sphere(3);
  const ScalarField alone = ms(large);
  Mesh small = shapes::sphere(1);
  for (Vec3& v : small.vertices) v *= 0.001;
  Mesh mesh = shapes::joined(large, small, 1.05 * large.vertices[100]);  // straight above vertex 100
  mesh.vertices.push_back(1.01 * mesh.vertices[7]);                      // isolated
  const ScalarField together = ms(mesh);
  const double shift = together[0] - alone[0];  // in the logarithm: R, the unit, is that of the whole shape
  for (std::size_t i = 0; i < alone.size(); ++i) ASSERT_NEAR(together[i], alone[i] + shift, 1e-9);
  for (std::size_t i = alone.size(); i + 1 < together.size(); ++i) EXPECT_EQ(together[i], together[100]);
  EXPECT_EQ(together.back(), together[7]);
  // The same where the small component comes first.
  const ScalarField second = ms(shapes::joined(shapes::sphere(1), large, {50, 0, 0}));
  const ScalarField tail(second.end() - std::ssize(alone), second.end());
  EXPECT_LT(largest_difference(min_max_normalised(tail), min_max_normalised(alone)), 1e-6);
}

TEST(Ms, MultiscaleMapDiffersFromTheSingleOneAndIsFinite) {
  for (const Mesh& mesh : {shapes::bumpy_sphere(3), shapes::bumpy_sphere(4), shapes::grid(60)}) {
    const ScalarField many = ms(mesh, MsOptions::text());
    ASSERT_EQ(many.size(), mesh.vertices.size());
    for (const double value : many) ASSERT_TRUE(std::isfinite(value));
    EXPECT_NE(many, ms(mesh));
  }
}

TEST(Ms, SmoothingThatReachesNoNeighbourLeavesNothingToCompare) {
  MsOptions options = MsOptions::text();
  options.epsilon = 1e-6;
  EXPECT_THAT(ms(shapes::bumpy_sphere(3), options), Each(0));
}

TEST(MsDegenerate, ComponentOfNineteenVertices) {
  // A strip of triangles 0-1-2, 1-2-3, ...
  Mesh strip;
  for (std::int32_t i = 0; i < 19; ++i) strip.vertices.emplace_back(i, i % 2, 0.01 * i * i);
  for (std::int32_t i = 0; i + 2 < 19; ++i) strip.faces.push_back({i, i + 1, i + 2});
  EXPECT_THAT(ms(strip), Each(0));
  strip.vertices.emplace_back(19, 1, 3.61);
  strip.faces.push_back({17, 18, 19});
  EXPECT_FALSE(is_constant(ms(strip)));
}

// A face for every three points.
Mesh complete(std::int32_t n) {
  Mesh mesh{shapes::random_cloud(index(n), 31), {}};
  for (std::int32_t a = 0; a < n; ++a)
    for (std::int32_t b = a + 1; b < n; ++b)
      for (std::int32_t c = b + 1; c < n; ++c) mesh.faces.push_back({a, b, c});
  return mesh;
}

TEST(MsDegenerate, ComponentThatIsSimplifiedToNineteenVertices) {
  // 120 faces that cannot be collapsed, and a strip of 10 that can.
  Mesh mesh = complete(10);
  for (std::int32_t i = 10; i < 20; ++i) {
    mesh.vertices.emplace_back(2 + i, i % 2, 0.01 * i * i);
    mesh.faces.push_back({i - 2, i - 1, i});
  }
  EXPECT_FALSE(is_constant(ms(mesh, {.faces = 130})));
  EXPECT_THAT(ms(mesh, {.faces = 129}), Each(0));
}

TEST(MsDegenerate, ConstantMapIsNoZero) {
  // Every vertex is a neighbour of every other: the means over one-rings are all equal.
  const ScalarField saliency = ms(complete(20));
  EXPECT_LT(largest_difference(saliency, ScalarField(20, saliency[0])), 1e-9);
  EXPECT_GT(std::abs(saliency[0]), 1);
}

TEST(MsDegenerate, ComponentWithoutArea) {
  Mesh strip;  // along a line
  for (std::int32_t i = 0; i < 30; ++i) strip.vertices.emplace_back(i + 0.1 * i * i, 0, 0);
  for (std::int32_t i = 0; i + 2 < 30; ++i) strip.faces.push_back({i, i + 1, i + 2});
  EXPECT_THAT(ms(strip), Each(0));
  EXPECT_FALSE(is_constant(ms(strip, {.weight = MsWeight::inverse_square})));  // divides by no area
}

TEST(MsDegenerate, ComponentInOnePlaceHasNoSpectrum) {
  Mesh mesh = shapes::sphere(2);
  for (Vec3& v : mesh.vertices) v = Vec3(1, 2, 3);
  mesh.vertices.emplace_back(4, 5, 6);  // so that not all points coincide
  for (MsOptions options : {MsOptions{}, MsOptions::text()}) {
    options.weight = MsWeight::inverse_square;
    EXPECT_THAT(ms(mesh, options), Each(0));
  }
}

TEST(MsDegenerate, FacesWithoutAreaAndDoubledOnesCountForNothing) {
  Mesh mesh = shapes::bumpy_sphere(3);
  const ScalarField expected = ms(mesh);
  mesh.faces.push_back({3, 3, 9});
  mesh.faces.push_back(mesh.faces[4]);
  EXPECT_EQ(ms(mesh), expected);
}

TEST(MsDegenerate, CoincidentVerticesAreAsThoseTheLeastDistanceApart) {
  const Mesh mesh = shapes::bumpy_sphere(3);
  const auto first = index(mesh.faces[0][0]);
  const auto second = index(mesh.faces[0][1]);
  const auto with_edge_times = [&](double factor) {
    Mesh changed = mesh;
    changed.vertices[second] = mesh.vertices[first] + factor * (mesh.vertices[second] - mesh.vertices[first]);
    return min_max_normalised(ms(changed));
  };
  EXPECT_LT(largest_difference(with_edge_times(1e-12), with_edge_times(1e-6)), 1e-5);
  EXPECT_LT(largest_difference(with_edge_times(0), with_edge_times(1e-6)), 0.01);  // both have one's value
  EXPECT_LT(largest_difference(with_edge_times(0), with_edge_times(1)), 0.25);
}

TEST(MsDegenerate, OpenAndNonManifoldSheetEqualsTheWholeDecomposition) {
  Mesh mesh = shapes::grid(15);
  mesh.faces.erase(mesh.faces.begin() + 200, mesh.faces.begin() + 210);  // a hole
  mesh.vertices.emplace_back(0.5, 0.5, 0.3);
  const auto fin = static_cast<std::int32_t>(mesh.vertices.size()) - 1;
  mesh.faces.push_back({100, 101, fin});  // the third face of an inner edge
  std::swap(mesh.faces[9][0], mesh.faces[9][1]);
  const ScalarField all = min_max_normalised(dense_saliency(mesh, MsWeight::area));
  EXPECT_LT(largest_difference(min_max_normalised(ms(mesh)), all), 1e-4);
}

}  // namespace
}  // namespace salbench
