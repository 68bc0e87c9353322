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
  const auto alone = same_on_any_number_of_threads([&] { return Bootstrap(7, 1000).means(columns).values; });
  EXPECT_NE(alone, Bootstrap(8, 1000).means(columns).values);
}

// What is drawn for a column does not depend on its neighbours.
TEST(Resampling, ColumnsShareTheirResamples) {
  const Columns columns = random_columns(25, 4);
  const Columns all = Bootstrap(1, 500).means(columns);
  for (std::size_t c = 0; c < columns.count; ++c)
    EXPECT_EQ(Bootstrap(1, 500).means({1, columns.column(c)}).values, all.column(c));
}

TEST(Resampling, SpreadIsThatOfAMean) {
  const Columns columns = random_columns(200, 1);
  const Summary sample = summarise(columns.values);
  const Summary means = summarise(Bootstrap(1).means(columns).values);
  EXPECT_NEAR(means.mean, sample.mean, 4 * means.sd / std::sqrt(kResamples));
  EXPECT_NEAR(means.sd, sample.sd * std::sqrt(199.0 / 200) / std::sqrt(200), .03 * means.sd);
}

TEST(Resampling, EqualValuesResampleToThemselves) {
  const Columns columns{1, std::vector<double>(7, 0.1)};
  EXPECT_THAT(Bootstrap(1, 100).means(columns).values, Each(0.1));
  EXPECT_EQ(columns.means(), std::vector{0.1});
}

TEST(Bca, NoneForOneValueOrEqualOnes) {
  for (const std::vector<double>& sample : {std::vector{0.3}, std::vector(9, 0.3)}) {
    const Interval interval = bca_interval(sample, Bootstrap(1, 100).means({1, sample}).values);
    EXPECT_TRUE(std::isnan(interval.low) && std::isnan(interval.high)) << sample.size();
  }
}

// The means are 0, 0.001 ... 1, so that the quantiles are the levels: worked out with SciPy's distributions.
// The acceleration is +-0.0962 for one value that differs from three, and 0 for even steps.
TEST(Bca, LevelsFollowBiasAndAcceleration) {
  std::vector<double> means;
  for (int i = 0; i <= 1000; ++i) means.push_back(i / 1000.0);
  const auto expect = [&](const std::vector<double>& sample, double low, double high) {
    const Interval interval = bca_interval(sample, means);
    EXPECT_NEAR(interval.low, low, 1e-9);
    EXPECT_NEAR(interval.high, high, 1e-9);
  };
  expect({0, 0, 0, 1}, 0.0027610911511, 0.7864734589205);
  expect({0, 0.5, 0.5, 0.5}, 0.0006054872999, 0.8642014368306);
  expect({0.2, 0.4, 0.6, 0.8}, 0.025, 0.975);
}

// The long tail is above: the interval reaches farther up than down, unlike Student's.
TEST(Bca, FollowsTheSkewOfTheSample) {
  const Columns columns = random_columns(50, 1);
  const double mean = columns.means()[0];
  const Interval interval = bca_interval(columns.values, Bootstrap(1).means(columns).values);
  EXPECT_GT(interval.high - mean, 1.2 * (mean - interval.low));
}

// Of a mean, and of whatever rises with it.
TEST(Percentiles, AreStudentsForNormalValues) {
  Rng rng(2, "columns", "");
  Columns columns{1, std::vector<double>(19)};
  for (double& value : columns.values) value = rng.normal();
  const Interval student = student_interval(summarise(columns.values));
  std::vector<double> means = Bootstrap(1).means(columns).values;
  const Interval found = percentile_interval(means, 19);
  const double width = student.high - student.low;
  EXPECT_NEAR(found.low, student.low, .05 * width);
  EXPECT_NEAR(found.high, student.high, .05 * width);
  for (double& mean : means) mean = std::exp(mean);
  EXPECT_EQ(percentile_interval(means, 19).low, std::exp(found.low));
  EXPECT_EQ(percentile_interval(means, 19).high, std::exp(found.high));
}

TEST(Percentiles, EndsMayBeInfinite) {
  std::vector<double> values(1000, 2);
  std::fill_n(values.begin(), 100, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(percentile_interval(values, 50).low, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(percentile_interval(values, 50).high, 2);
}

TEST(Percentiles, NoneForFewUnitsEqualValuesAndUndefinedOnes) {
  const auto none = [](std::vector<double> values, std::size_t units) {
    const Interval interval = percentile_interval(std::move(values), units);
    return std::isnan(interval.low) && std::isnan(interval.high);
  };
  EXPECT_TRUE(none({1, 2, 3, 4}, 5));
  EXPECT_FALSE(none({1, 2, 3, 4}, 6));
  EXPECT_TRUE(none({2, 2, 2, 2}, 6));
  EXPECT_TRUE(none({1, 2, 3, std::nan("")}, 6));
  EXPECT_TRUE(none({}, 6));
}

}  // namespace
}  // namespace salbench
