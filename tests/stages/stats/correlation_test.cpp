// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stats/correlation.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "stages/core/rng.h"

namespace salbench {
namespace {

using Sample = std::vector<double>;

const double kNan = std::nan("");

TEST(Pearson, FourPairsByHand) {
  // Deviations (-1.5, -.5, .5, 1.5) and (-1, 1, -1, 1): 2 / sqrt(5 * 4).
  EXPECT_NEAR(pearson(Sample{1, 2, 3, 4}, Sample{1, 3, 1, 3}), 2 / std::sqrt(20.0), 1e-15);
}

TEST(Pearson, SeesOnlyTheDirectionOfALine) {
  const Sample x = {0.3, -2, 7, 11, 4.5};
  Sample up, down;
  for (const double value : x) {
    up.push_back(3e-5 * value + 1000);
    down.push_back(-9 * value + 2);
  }
  EXPECT_NEAR(pearson(x, up), 1, 1e-7);
  EXPECT_NEAR(pearson(x, down), -1, 1e-15);
  EXPECT_LE(pearson(x, x), 1);
}

TEST(Pearson, IsNeverBeyondOneByRounding) {
  Rng rng(1, "pearson", "");
  for (int round = 0; round < 2000; ++round) {
    Sample x(3 + rng.below(20)), same, opposite;
    for (double& value : x) value = rng.normal();
    for (const double value : x) {
      same.push_back(3 * value);
      opposite.push_back(-7 * value);
    }
    ASSERT_LE(pearson(x, same), 1);
    ASSERT_NEAR(pearson(x, same), 1, 1e-14);
    ASSERT_GE(pearson(x, opposite), -1);
  }
}

TEST(Pearson, OfAConstantIsUndefined) {
  EXPECT_TRUE(std::isnan(pearson(Sample{0.1, 0.1, 0.1}, Sample{1, 2, 3})));
  EXPECT_TRUE(std::isnan(pearson(Sample{1}, Sample{2})));
  EXPECT_TRUE(std::isnan(pearson(Sample{}, Sample{})));
}

TEST(Pearson, IsThatOfAnyMultiple) {
  const Sample x = {1, 2, 3, 4}, y = {1, 3, 1, 3};
  Sample large_x, large_y;
  for (const double value : x) large_x.push_back(std::ldexp(value, 1020));
  for (const double value : y) large_y.push_back(std::ldexp(value - 2, 1023));
  EXPECT_EQ(pearson(large_x, large_y), pearson(x, y));
  EXPECT_EQ(spearman(large_x, large_y), spearman(x, y));
}

TEST(Spearman, SeesOnlyTheOrder) {
  const Sample x = {0.1, 5, 2, 3, 80};
  Sample y;
  for (const double value : x) y.push_back(-std::log(value));
  EXPECT_NEAR(spearman(x, y), -1, 1e-15);
}

TEST(Spearman, WithoutTiesIsTheFormulaOfSquaredRankDifferences) {
  // Ranks 1 2 3 4 5 and 2 1 4 3 5: 1 - 6 * 4 / (5 * 24).
  EXPECT_NEAR(spearman(Sample{1, 2, 3, 4, 5}, Sample{20, 10, 40, 30, 50}), 0.8, 1e-15);
}

TEST(Correlation, LeavesOutPairsWithANan) {
  const Sample x = {1, 2, kNan, 3, 4, 9}, y = {1, 3, 7, 1, 3, kNan};
  EXPECT_NEAR(pearson(x, y), 2 / std::sqrt(20.0), 1e-15);
  EXPECT_NEAR(spearman(x, y), 2 / std::sqrt(20.0), 1e-15);
  EXPECT_TRUE(std::isnan(spearman(Sample{kNan, 1}, Sample{1, kNan})));
}

TEST(Correlation, RefusesSamplesOfDifferentLength) {
  EXPECT_THROW(pearson(Sample{1, 2}, Sample{1}), std::logic_error);
  EXPECT_THROW(spearman(Sample{1, 2}, Sample{1}), std::logic_error);
}

}  // namespace
}  // namespace salbench
