// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stats/summary.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace salbench {
namespace {

const double kNan = std::nan("");

TEST(Summarise, FiveValuesByHand) {
  const Summary s = summarise(std::vector<double>{1, 2, 3, 4, 5});
  EXPECT_EQ(s.n, 5);
  EXPECT_DOUBLE_EQ(s.mean, 3);
  EXPECT_DOUBLE_EQ(s.sd, std::sqrt(2.5));
  const double half = 2.7764451051977987 * std::sqrt(0.5);  // t(0.975, 4) of the tables
  EXPECT_NEAR(s.ci_low, 3 - half, 1e-12);
  EXPECT_NEAR(s.ci_high, 3 + half, 1e-12);
}

TEST(Summarise, TwoValuesHaveTheCauchyInterval) {
  const Summary s = summarise(std::vector<double>{-1, 1});
  EXPECT_NEAR(s.ci_high, 12.706204736174698, 1e-9);  // tan(0.475 pi)
  EXPECT_NEAR(s.ci_low, -12.706204736174698, 1e-9);
}

TEST(Summarise, OfLargeValuesIsFinite) {
  const Summary s = summarise(std::vector<double>{1e308, 1.2e308, 1.1e308});
  EXPECT_NEAR(s.mean / 1.1e308, 1, 1e-15);
  EXPECT_NEAR(s.sd / 1e307, 1, 1e-12);
  const double half = 4.302652729749464e307 / std::sqrt(3.0);  // t(0.975, 2) of the tables
  EXPECT_NEAR(s.ci_low / (1.1e308 - half), 1, 1e-9);
  EXPECT_NEAR(s.ci_high / (1.1e308 + half), 1, 1e-9);
  EXPECT_EQ(summarise(std::vector<double>{-1.7e308, 1.7e308}).mean, 0);
}

TEST(Summarise, CountsAndLeavesOutTheUndefined) {
  const Summary s = summarise(std::vector<double>{kNan, 2, kNan, 4});
  EXPECT_EQ(s.n, 2);
  EXPECT_EQ(s.n_undefined, 2);
  EXPECT_DOUBLE_EQ(s.mean, 3);
  EXPECT_DOUBLE_EQ(s.sd, std::sqrt(2.0));
}

TEST(Summarise, OneValueHasAMeanAndNoInterval) {
  const Summary s = summarise(std::vector<double>{7, kNan});
  EXPECT_EQ(s.n, 1);
  EXPECT_DOUBLE_EQ(s.mean, 7);
  EXPECT_TRUE(std::isnan(s.sd));
  EXPECT_TRUE(std::isnan(s.ci_low));
  EXPECT_TRUE(std::isnan(s.ci_high));
}

TEST(Summarise, NothingHasNoMean) {
  for (const std::vector<double>& sample : {std::vector<double>{}, {kNan, kNan}}) {
    const Summary s = summarise(sample);
    EXPECT_EQ(s.n, 0);
    EXPECT_EQ(s.n_undefined, static_cast<std::int64_t>(sample.size()));
    EXPECT_TRUE(std::isnan(s.mean));
    EXPECT_TRUE(std::isnan(s.ci_low));
  }
}

TEST(Summarise, EqualValuesDoNotVaryAtAll) {
  const Summary s = summarise(std::vector<double>(3, 0.1));  // 0.1 + 0.1 + 0.1 rounds
  EXPECT_EQ(s.mean, 0.1);
  EXPECT_EQ(s.sd, 0);
  EXPECT_EQ(s.ci_low, 0.1);
}

TEST(Summarise, KeepsItsDigitsFarFromZero) {
  const Summary s = summarise(std::vector<double>{1e9 + 1, 1e9 + 2, 1e9 + 3});
  EXPECT_DOUBLE_EQ(s.mean, 1e9 + 2);
  EXPECT_DOUBLE_EQ(s.sd, 1);
}

TEST(Quantile, IsLinearBetweenOrderStatistics) {
  const std::vector<double> values = {40, 10, kNan, 30, 20};
  EXPECT_DOUBLE_EQ(quantile(values, 0), 10);
  EXPECT_DOUBLE_EQ(quantile(values, 0.25), 17.5);
  EXPECT_DOUBLE_EQ(median(values), 25);
  EXPECT_DOUBLE_EQ(quantile(values, 0.9), 37);
  EXPECT_DOUBLE_EQ(quantile(values, 1), 40);
}

TEST(Quantile, OfOneValueAndOfNone) {
  EXPECT_DOUBLE_EQ(quantile(std::vector<double>{3}, 0.3), 3);
  EXPECT_TRUE(std::isnan(median(std::vector<double>{})));
  EXPECT_TRUE(std::isnan(median(std::vector<double>{kNan})));
}

TEST(Quantile, RefusesFractionsBeyondOne) {
  EXPECT_THROW(quantile(std::vector<double>{1, 2}, 95), std::logic_error);
  EXPECT_THROW(quantile(std::vector<double>{1, 2}, -0.1), std::logic_error);
}

}  // namespace
}  // namespace salbench
