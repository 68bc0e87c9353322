// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stats/paired.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "stages/core/rng.h"

namespace salbench {
namespace {

using Sample = std::vector<double>;

TEST(PairedComparison, OfAHandMadeExample) {
  const PairedComparison found = compare_paired(Sample{3, 5, 4, 9}, Sample{2, 3, 5, 5});  // 1, 2, -1, 4
  EXPECT_EQ(found.n, 4);
  EXPECT_DOUBLE_EQ(found.mean_difference, 1.5);
  EXPECT_DOUBLE_EQ(found.d_z, 1.5 / std::sqrt(13.0 / 3));
  EXPECT_DOUBLE_EQ(found.rank_biserial, (8.5 - 1.5) / 10);  // ranks 1.5, 3, -1.5, 4
  EXPECT_DOUBLE_EQ(found.superiority, 0.75);
  const double half = 2.353363434801824 * std::sqrt(13.0 / 3) / 2;  // t(0.95, 3) of the tables
  EXPECT_NEAR(found.equivalence_interval.low, 1.5 - half, 1e-12);
  EXPECT_NEAR(found.equivalence_interval.high, 1.5 + half, 1e-12);
}

TEST(PairedComparison, HasTheIntervalOfTheTestOfEquivalence) {
  const Sample a{1, 2, 3, 4.5, 2}, b{2, 2, 1, 3, 1.5}, differences{-1, 0, 2, 1.5, 0.5};
  const Interval of_test = test_equivalence(differences, 1).interval;
  EXPECT_EQ(compare_paired(a, b).equivalence_interval.low, of_test.low);
  EXPECT_EQ(compare_paired(a, b).equivalence_interval.high, of_test.high);
}

TEST(PairedComparison, SwapsWithItsModels) {
  const Sample a{1, 2, 3, 4.5, 2}, b{2, 2, 1, 3, 1.5};
  const PairedComparison ab = compare_paired(a, b), ba = compare_paired(b, a);
  EXPECT_EQ(ab.mean_difference, -ba.mean_difference);
  EXPECT_EQ(ab.interval.low, -ba.interval.high);
  EXPECT_EQ(ab.t_p, ba.t_p);
  EXPECT_DOUBLE_EQ(ab.rank_biserial, -ba.rank_biserial);
  EXPECT_DOUBLE_EQ(ab.superiority, 1 - ba.superiority);
  EXPECT_NEAR(ab.superiority_interval.low, 1 - ba.superiority_interval.high, 1e-15);
}

TEST(PairedComparison, OneUnitHasADifferenceAndNothingElse) {
  const PairedComparison found = compare_paired(Sample{3}, Sample{2});
  EXPECT_EQ(found.mean_difference, 1);
  for (const double none : {found.interval.low, found.interval.high, found.t_p, found.d_z,
                            found.rank_biserial, found.superiority, found.superiority_interval.low})
    EXPECT_TRUE(std::isnan(none));
}

TEST(PairedComparison, ModelsThatAgreeEverywhereHaveNoInterval) {
  const PairedComparison found = compare_paired(Sample(5, 2.0), Sample(5, 2.0));
  EXPECT_EQ(found.t_p, 1);
  EXPECT_EQ(found.superiority, 0.5);
  EXPECT_EQ(found.rank_biserial, 0);
  EXPECT_TRUE(std::isnan(found.interval.low));
  EXPECT_TRUE(std::isnan(found.d_z));
}

// Two roads to one answer.
TEST(PairedComparison, TestAndIntervalDecideAlike) {
  Rng rng(1, "paired", "");
  int significant = 0;
  for (int round = 0; round < 300; ++round) {
    Sample a(10), b(10);
    for (double& value : a) value = rng.normal() + 0.7;
    for (double& value : b) value = rng.normal();
    const PairedComparison found = compare_paired(a, b);
    const bool leaves_out_0 = found.interval.low > 0 || found.interval.high < 0;
    EXPECT_EQ(found.t_p < 0.05, leaves_out_0);
    significant += leaves_out_0 ? 1 : 0;
  }
  EXPECT_GT(significant, 30);
  EXPECT_LT(significant, 270);
}

TEST(Equivalence, RejectsExactlyWhereItsIntervalLiesWithinTheMargins) {
  Rng rng(1, "equivalence", "");
  int equivalent = 0;
  for (int round = 0; round < 300; ++round) {
    Sample differences(12);
    for (double& value : differences) value = rng.normal() + 0.3;
    const Equivalence found = test_equivalence(differences, 0.8);
    const bool within = found.interval.low > -0.8 && found.interval.high < 0.8;
    EXPECT_EQ(found.p_value < 0.05, within);
    equivalent += within ? 1 : 0;
  }
  EXPECT_GT(equivalent, 30);
  EXPECT_LT(equivalent, 270);
}

TEST(Equivalence, ModelsThatAgreeEverywhereAreEquivalentAndOneUnitDecidesNothing) {
  EXPECT_EQ(test_equivalence(Sample(4, 0.0), 0.01).p_value, 0);
  EXPECT_EQ(test_equivalence(Sample(4, 0.02), 0.01).p_value, 1);
  EXPECT_TRUE(std::isnan(test_equivalence(Sample{0}, 0.01).p_value));
}

TEST(WilsonInterval, StaysWithinARangeOfItsOwn) {
  const Interval none = wilson_interval(0, 10), half = wilson_interval(0.5, 10);
  EXPECT_EQ(none.low, 0);
  EXPECT_NEAR(none.high, 0.2775, 1e-4);  // z^2 / (n + z^2)
  EXPECT_NEAR(half.low, 0.2366, 1e-4);
  EXPECT_NEAR(half.high, 0.7634, 1e-4);
}

TEST(Power, InvertsItself) {
  std::vector<std::int64_t> sizes = {100, 399, 400};
  for (std::int64_t n = 2; n <= 40; ++n) sizes.push_back(n);
  for (const std::int64_t n : sizes) {
    const double difference = detectable_difference(0.3, n);
    EXPECT_NEAR(power_of_paired_test(difference, 0.3, static_cast<double>(n)), kPower, 1e-9);
    EXPECT_EQ(units_to_detect(difference * (1 + 1e-9), 0.3), n);
  }
  EXPECT_EQ(units_to_detect(0, 0.3), -1);
  EXPECT_EQ(units_to_detect(1e9, 0.3), 2);
  EXPECT_TRUE(std::isnan(detectable_difference(0.3, 1)));
}

TEST(Power, DependsOnTheDifferenceInDeviationsAlone) {
  for (const double unit : {1e-6, 0.3, 1e6})
    EXPECT_NEAR(power_of_paired_test(0.7 * unit, unit, 12), power_of_paired_test(0.7, 1, 12), 1e-12) << unit;
  EXPECT_EQ(power_of_paired_test(-0.7, 1, 12), power_of_paired_test(0.7, 1, 12));
}

// The share of simulated tests that find a difference which is there.
TEST(Power, IsWhatSimulationFinds) {
  Rng rng(1, "power", "");
  const int n = 15, rounds = 4000;
  const double difference = detectable_difference(1, n);
  int found = 0;
  for (int round = 0; round < rounds; ++round) {
    Sample a(n), b(n, 0.0);
    for (double& value : a) value = difference + rng.normal();
    found += compare_paired(a, b).t_p < 0.05 ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(found) / rounds, kPower, 4 * std::sqrt(kPower * (1 - kPower) / rounds));
}

}  // namespace
}  // namespace salbench
