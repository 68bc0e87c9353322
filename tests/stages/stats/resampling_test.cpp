// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stats/resampling.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/rng.h"
#include "stages/stats/summary.h"
#include "tests/support/threads.h"

namespace salbench {
namespace {

using testing::Each;

Columns random_columns(std::size_t units, std::size_t count) {
  Rng rng(1, "columns", "");
  Columns columns{count, std::vector<double>(units * count)};
  for (double& value : columns.values) value = std::exp(rng.normal());
  return columns;
}

TEST(Resampling, SameBytesForAnyNumberOfThreads) {
  const Columns columns = random_columns(40, 3);
  const auto alone = same_on_any_number_of_threads([&] { return resampled_means(columns, 7, 1000).values; });
  EXPECT_NE(alone, resampled_means(columns, 8, 1000).values);
}

// What is drawn for a column does not depend on its neighbours.
TEST(Resampling, ColumnsShareTheirResamples) {
  const Columns columns = random_columns(25, 4);
  const Columns all = resampled_means(columns, 1, 500);
  for (std::size_t c = 0; c < columns.count; ++c)
    EXPECT_EQ(resampled_means({1, columns.column(c)}, 1, 500).values, all.column(c));
}

TEST(Resampling, SpreadIsThatOfAMean) {
  const Columns columns = random_columns(200, 1);
  const Summary sample = summarise(columns.values);
  const Summary means = summarise(resampled_means(columns, 1).values);
  EXPECT_NEAR(means.mean, sample.mean, 4 * means.sd / std::sqrt(kResamples));
  EXPECT_NEAR(means.sd, sample.sd * std::sqrt(199.0 / 200) / std::sqrt(200), .03 * means.sd);
}

TEST(Resampling, EqualValuesResampleToThemselves) {
  const Columns columns{1, std::vector<double>(7, 0.1)};
  EXPECT_THAT(resampled_means(columns, 1, 100).values, Each(0.1));
  EXPECT_EQ(columns.means(), std::vector{0.1});
}

TEST(Bca, NoneForOneValueOrEqualOnes) {
  for (const std::vector<double>& sample : {std::vector{0.3}, std::vector(9, 0.3)}) {
    const Interval interval = bca_interval(sample, resampled_means({1, sample}, 1, 100).values);
    EXPECT_TRUE(std::isnan(interval.low) && std::isnan(interval.high)) << sample.size();
  }
}

// The long tail is above: the interval reaches farther up than down, unlike Student's.
TEST(Bca, FollowsTheSkewOfTheSample) {
  const Columns columns = random_columns(50, 1);
  const double mean = columns.means()[0];
  const Interval interval = bca_interval(columns.values, resampled_means(columns, 1).values);
  EXPECT_GT(interval.high - mean, 1.2 * (mean - interval.low));
}

}  // namespace
}  // namespace salbench
