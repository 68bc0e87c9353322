// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/spectrum.h"

#include <Eigen/Eigenvalues>

#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

SparseMatrix laplacian_of(const Mesh& mesh) {
  return graph_laplacian(
      inverse_square_weights(mesh.vertices, edge_adjacency(mesh.vertices.size(), mesh.faces)));
}

TEST(Spectrum, CycleHasEachValueTwice) {
  const int n = 30;
  std::vector<Vec3> points;
  Faces edges;  // without area
  std::vector<double> expected;
  const double radius = 0.5 / std::sin(std::numbers::pi / n);  // edges of unit length
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
    edges.push_back({i, (i + 1) % n, i});
    expected.push_back(2 - 2 * std::cos(angle));
  }
  std::ranges::sort(expected);
  expected.resize(8);
  const Eigen::VectorXd found =
      lowest_eigenpairs(graph_laplacian(inverse_square_weights(points, edge_adjacency(30, edges))), 8).values;
  EXPECT_THAT(std::vector(found.begin(), found.end()), Pointwise(DoubleNear(1e-12), expected));
}

TEST(Spectrum, WeightsFallWithTheSquareOfTheDistance) {
  const std::vector<Vec3> points = {{0, 0, 0}, {2, 0, 0}, {2, 4, 0}};
  const SparseMatrix weights = inverse_square_weights(points, edge_adjacency(3, Faces{{0, 1, 1}, {1, 2, 2}}));
  EXPECT_DOUBLE_EQ(weights.coeff(0, 1), 1.0 / 4);
  EXPECT_DOUBLE_EQ(weights.coeff(2, 1), 1.0 / 16);
  EXPECT_EQ(weights.coeff(0, 2), 0);
  const SparseMatrix laplacian = graph_laplacian(weights);
  EXPECT_DOUBLE_EQ(laplacian.coeff(1, 1), 5.0 / 16);
  EXPECT_LT((laplacian * Eigen::VectorXd::Ones(3)).norm(), 1e-15);
}

TEST(Spectrum, CoincidentPointsHaveAFiniteWeight) {
  const std::vector<Vec3> points = {{0, 0, 0}, {0, 0, 0}, {2, 0, 0}};
  const SparseMatrix weights = inverse_square_weights(points, edge_adjacency(3, Faces{{0, 1, 1}, {1, 2, 2}}));
  EXPECT_NEAR(weights.coeff(0, 1), 1e8, 1);  // the mean edge is 1
}

TEST(Spectrum, EigenpairsEqualADenseSolver) {
  const SparseMatrix laplacian = laplacian_of(shapes::bumpy_sphere(2));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> dense{Eigen::MatrixXd(laplacian)};
  const double largest = dense.eigenvalues().maxCoeff();
  const Eigenpairs pairs = lowest_eigenpairs(laplacian, 14);
  ASSERT_EQ(pairs.values.size(), 14);
  EXPECT_LT((pairs.values - dense.eigenvalues().head(14)).cwiseAbs().maxCoeff(), 1e-13 * largest);
  const Eigen::MatrixXd gram = pairs.vectors.transpose() * pairs.vectors;
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(14, 14)).cwiseAbs().maxCoeff(), 1e-10);
  for (Eigen::Index k = 0; k < 14; ++k)
    EXPECT_NEAR(std::abs(pairs.vectors.col(k).dot(dense.eigenvectors().col(k))), 1, 1e-8) << k;
}

// Powers of two, without rounding: the same pairs in another unit of length.
TEST(Spectrum, EigenvaluesScaleWithTheLaplacian) {
  const SparseMatrix laplacian = laplacian_of(shapes::bumpy_sphere(2));
  const Eigenpairs pairs = lowest_eigenpairs(laplacian, 10);
  ASSERT_EQ(pairs.values.size(), 10);
  for (const double scale : {0x1p-60, 0x1p-20, 0x1p20}) {
    const Eigenpairs scaled = lowest_eigenpairs(scale * laplacian, 10);
    ASSERT_EQ(scaled.values.size(), 10) << scale;
    EXPECT_LT((scaled.values / scale - pairs.values).cwiseAbs().maxCoeff(), 1e-9 * pairs.values[9]) << scale;
    for (Eigen::Index k = 0; k < 10; ++k)
      EXPECT_NEAR(std::abs(scaled.vectors.col(k).dot(pairs.vectors.col(k))), 1, 1e-8) << scale << " " << k;
  }
}

TEST(Spectrum, SphereHasItsRepeatedValuesAsOftenAsTheyOccur) {
  const SparseMatrix laplacian = laplacian_of(shapes::sphere(2));  // 1, 3, 5, 3 + 4, ...
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> dense{Eigen::MatrixXd(laplacian)};
  for (const Eigen::Index k : {4, 9, 14, 18}) {
    const Eigenpairs pairs = lowest_eigenpairs(laplacian, k);
    ASSERT_EQ(pairs.values.size(), k);
    EXPECT_LT((pairs.values - dense.eigenvalues().head(k)).cwiseAbs().maxCoeff(),
              1e-12 * dense.eigenvalues().maxCoeff());
  }
}

TEST(Spectrum, OfASurfaceDependsOnNeitherUnitNorPlace) {
  Mesh mesh = shapes::sphere(2);
  const Eigenpairs before = spectrum_of(mesh.vertices, mesh.faces, 6);
  for (Vec3& p : mesh.vertices) p = 1e40 * p + Vec3(2e40, 0, 0);
  const Eigenpairs after = spectrum_of(mesh.vertices, mesh.faces, 6);
  for (Eigen::Index k = 0; k < 6; ++k)
    EXPECT_NEAR(after.values[k], before.values[k], 1e-9 * before.values[5]);
}

TEST(Spectrum, OfASurfaceThatIsNotOnePartIsRefused) {
  Mesh mesh = shapes::sphere(1);
  EXPECT_THROW(spectrum_of(mesh.vertices, mesh.faces, 1), InputError);
  EXPECT_THROW(spectrum_of(mesh.vertices, mesh.faces, mesh.vertices.size() - 1), InputError);
  EXPECT_THROW(spectrum_of({}, {}, 2), InputError);
  mesh.vertices.emplace_back(9, 9, 9);
  EXPECT_THROW(spectrum_of(mesh.vertices, mesh.faces, 2), InputError);
}

TEST(Spectrum, MatrixOfNothingButZeroHasNoPairsAndDoesNotThrow) {
  EXPECT_EQ(lowest_eigenpairs(SparseMatrix(30, 30), 14).values.size(), 0);
}

TEST(Spectrum, WeightsThatAreNotFiniteHaveNoPairs) {
  const std::vector<Vec3> points(40, {1, 2, 3});  // all edges have length 0
  Faces edges;                                    // without area
  for (int i = 0; i + 1 < 40; ++i) edges.push_back({i, i + 1, i});
  const SparseMatrix weights = inverse_square_weights(points, edge_adjacency(points.size(), edges));
  EXPECT_TRUE(std::isinf(weights.coeff(0, 1)));
  EXPECT_EQ(lowest_eigenpairs(graph_laplacian(weights), 14).values.size(), 0);
}

}  // namespace
}  // namespace salbench
