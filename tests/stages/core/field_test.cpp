// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/field.h"

#include <cmath>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/rng.h"

namespace salbench {
namespace {

using testing::ElementsAre;

TEST(MinMaxNormalised, SpansTheUnitIntervalAndTakesNanAsZero) {
  EXPECT_THAT(min_max_normalised(std::vector<double>{-1, std::nan(""), 3}), ElementsAre(0, 0.25, 1));
}

TEST(MinMaxNormalised, LeavesAConstantFieldAsItIs) {
  EXPECT_THAT(min_max_normalised(std::vector<double>{5, 5, 5}), ElementsAre(5, 5, 5));
  EXPECT_TRUE(min_max_normalised(std::vector<double>{}).empty());
}

TEST(BinnedDensity, IntegratesToOneOverItsEdges) {
  Rng rng(1, "field", "");
  std::vector<double> field(3000);
  for (double& v : field) v = -2 + 7 * rng.uniform() * rng.uniform();
  const BinnedDensity h = binned_density(field);
  double integral = 0;
  for (std::size_t i = 0; i < kHistogramBins; ++i) integral += h.density[i] * (h.edges[i + 1] - h.edges[i]);
  EXPECT_NEAR(integral, 1, 1e-12);
}

TEST(BinnedDensity, EdgesBelongToTheRightAndTheLastToTheLeft) {
  std::vector<double> field(101);
  std::iota(field.begin(), field.end(), 0.0);
  const BinnedDensity h = binned_density(field);
  for (std::size_t i = 0; i + 1 < kHistogramBins; ++i) EXPECT_NEAR(h.density[i], 1 / 101.0, 1e-12) << i;
  EXPECT_NEAR(h.density.back(), 2 / 101.0, 1e-12);
}

TEST(BinnedDensity, ConstantFieldFallsInTheMiddle) {
  const BinnedDensity h = binned_density(std::vector<double>{3, 3, 3});
  EXPECT_DOUBLE_EQ(h.edges.front(), 2.5);
  EXPECT_NEAR(h.density[50], 100, 1e-9);
}

TEST(PickedPoints, AreDistinctAndAscending) {
  GroundTruth truth;
  truth.picks = {{9, 2, 2}, {}, {2, 5}};
  EXPECT_THAT(picked_points(truth), ElementsAre(2, 5, 9));
}

}  // namespace
}  // namespace salbench
