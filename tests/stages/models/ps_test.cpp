// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/ps.h"

#include "stages/descriptors/fpfh.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

ScalarField saliency_of(const Descriptors& descriptors, const PsOptions& options = {}) {
  const std::vector<Vec3> points(descriptors.size(), Vec3::Zero());
  return ps_saliency(points, descriptors, options);
}

// Rows of a flat patch, all weight in bins 5, 16 and 27, some of which is moved one bin up by `share`.
Descriptors nearly_flat(const std::vector<float>& shares) {
  Descriptors descriptors;
  for (const float share : shares) {
    std::array<float, kFpfhBins> row{};
    for (const std::size_t flat : {5U, 16U, 27U}) {
      row[flat] = 100 * (1 - share);
      row[flat + 1] = 100 * share;
    }
    descriptors.values.insert(descriptors.values.end(), row.begin(), row.end());
  }
  return descriptors;
}

Descriptors random_descriptors(std::size_t n, std::uint64_t seed) {
  return fpfh(shapes::random_cloud(n, seed), shapes::random_normals(n, seed + 1), FpfhOptions{});
}

TEST(PsSaliency, OfOneDirectionIsTheDistanceAlongIt) {
  // Moving a share s of three blocks by one bin is a step of 100 s in 6 of the 33 directions.
  const ScalarField saliency = saliency_of(nearly_flat({0, 0, 0, 0.1F, 0.3F}));
  const double step = 100 * std::sqrt(6.0), mean = 0.08;
  const double shares[] = {0, 0, 0, 0.1, 0.3};
  for (std::size_t i = 0; i < saliency.size(); ++i)
    EXPECT_NEAR(saliency[i], step * (shares[i] - mean), 1e-4) << i;
}

TEST(PsSaliency, PutsFlatPlacesLowAlsoWhereTheyAreFew) {
  const ScalarField saliency = saliency_of(nearly_flat({0, 0.9F, 1, 1, 1}));
  EXPECT_EQ(std::ranges::min_element(saliency) - saliency.begin(), 0);
}

TEST(PsSaliency, AbsoluteIsTheMagnitude) {
  const Descriptors descriptors = random_descriptors(200, 71);
  const ScalarField is_signed = saliency_of(descriptors);
  const ScalarField absolute = saliency_of(descriptors, {.absolute = true});
  EXPECT_LT(std::ranges::min(is_signed), 0);
  for (std::size_t i = 0; i < is_signed.size(); ++i) EXPECT_EQ(absolute[i], std::abs(is_signed[i]));
}

TEST(PsSaliency, HasMeanZeroAndTheLargestVarianceOfAllDirections) {
  const Descriptors descriptors = random_descriptors(400, 73);
  const auto n = static_cast<double>(descriptors.size());
  const ScalarField saliency = saliency_of(descriptors);
  EXPECT_NEAR(std::accumulate(saliency.begin(), saliency.end(), 0.0) / n, 0, 1e-9);

  // Reference: power iteration on the data itself, without a covariance or a solver.
  std::vector<Eigen::VectorXd> centred;
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(kFpfhBins);
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    Eigen::VectorXd row(kFpfhBins);
    for (std::size_t b = 0; b < kFpfhBins; ++b) row[static_cast<Eigen::Index>(b)] = descriptors.row(i)[b];
    centred.push_back(row);
    mean += row / n;
  }
  for (Eigen::VectorXd& row : centred) row -= mean;
  Eigen::VectorXd axis = Eigen::VectorXd::LinSpaced(kFpfhBins, 1, 2);
  for (int round = 0; round < 3000; ++round) {
    Eigen::VectorXd next = Eigen::VectorXd::Zero(kFpfhBins);
    for (const Eigen::VectorXd& row : centred) next += row.dot(axis) * row;
    axis = next.normalized();
  }
  if (axis[5] + axis[16] + axis[27] > 0) axis = -axis;
  for (std::size_t i = 0; i < centred.size(); ++i) EXPECT_NEAR(saliency[i], axis.dot(centred[i]), 1e-6) << i;
}

TEST(PsSaliency, IsNothingWhereAllDescriptorsAreEqual) {
  EXPECT_THAT(saliency_of(nearly_flat({0.5F, 0.5F, 0.5F, 0.5F})), Each(0.0));
  EXPECT_THAT(saliency_of(nearly_flat({0.25F})), Each(0.0));
  EXPECT_TRUE(saliency_of({}).empty());
}

}  // namespace
}  // namespace salbench
