// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stats/rank_tests.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/rng.h"
#include "stages/stats/ranks.h"

namespace salbench {
namespace {

using testing::ElementsAre;
using Sample = std::vector<double>;

const double kNan = std::nan("");

Sample normals(std::size_t n, std::uint64_t seed, double shift = 0) {
  Rng rng(seed, "sample", "");
  Sample sample(n);
  for (double& value : sample) value = shift + rng.normal();
  return sample;
}

TEST(Midranks, EqualValuesShareTheirMean) {
  const Ranks ranks = midranks(Sample{3, 1, 3, 2, 3, 1});
  EXPECT_THAT(ranks.rank, ElementsAre(5, 1.5, 5, 3, 5, 1.5));
  EXPECT_EQ(ranks.ties, (27 - 3) + (8 - 2));
}

TEST(RankSum, ThreeAgainstFourByHand) {
  const RankSum test = rank_sum_test(Sample{1, 2, 4}, Sample{3, 5, 6, 7});
  EXPECT_EQ(test.u, 1);  // only 4 lies above 3
  EXPECT_NEAR(test.z, (1 - 6) / std::sqrt(8.0), 1e-15);
  EXPECT_NEAR(test.p_value, std::erfc(5 / 4.0), 1e-15);
}

TEST(RankSum, TiesNarrowTheVarianceOnlyWhenAsked) {
  const Sample x = {1, 2, 2}, y = {2, 3, 3};  // one group of three, one of two
  const RankSum plain = rank_sum_test(x, y), corrected = rank_sum_test(x, y, TieVariance::corrected);
  EXPECT_EQ(plain.u, 1);
  EXPECT_NEAR(plain.z, -3.5 / std::sqrt(9.0 / 12 * 7), 1e-14);
  EXPECT_NEAR(corrected.z, -3.5 / std::sqrt(9.0 / 12 * (7 - 30.0 / 30)), 1e-14);
  EXPECT_LT(corrected.p_value, plain.p_value);
}

TEST(RankSum, CountsThePairsWhereXIsAbove) {
  Rng rng(3, "pairs", "");
  for (int round = 0; round < 20; ++round) {
    Sample x(1 + rng.below(20)), y(1 + rng.below(20));
    for (Sample* sample : {&x, &y})
      for (double& value : *sample) value = static_cast<double>(rng.below(10));
    double above = 0;
    for (const double a : x)
      for (const double b : y) above += a > b ? 1 : a == b ? 0.5 : 0;
    EXPECT_EQ(rank_sum_test(x, y).u, above);
  }
}

TEST(RankSum, SwappingTheSamplesTurnsTheSign) {
  const Sample x = normals(12, 1), y = normals(30, 2, 0.7);
  const RankSum there = rank_sum_test(x, y), back = rank_sum_test(y, x);
  EXPECT_DOUBLE_EQ(there.z, -back.z);
  EXPECT_DOUBLE_EQ(there.p_value, back.p_value);
}

TEST(RankSum, LeavesOutTheUndefined) {
  const RankSum test = rank_sum_test(Sample{1, kNan, 2, 4}, Sample{3, 5, 6, 7, kNan});
  EXPECT_EQ(test.n_x, 3);
  EXPECT_EQ(test.n_y, 4);
  EXPECT_EQ(test.p_value, rank_sum_test(Sample{1, 2, 4}, Sample{3, 5, 6, 7}).p_value);
}

TEST(RankSum, OfAnEmptySampleIsUndefined) {
  EXPECT_TRUE(std::isnan(rank_sum_test(Sample{}, Sample{1, 2}).p_value));
  EXPECT_TRUE(std::isnan(rank_sum_test(Sample{1}, Sample{kNan}).z));
}

TEST(RankSum, EqualValuesSayNothing) {
  for (const TieVariance ties : {TieVariance::ignored, TieVariance::corrected}) {
    const RankSum test = rank_sum_test(Sample(5, 2.0), Sample(7, 2.0), ties);
    EXPECT_EQ(test.z, 0);
    EXPECT_EQ(test.p_value, 1);
  }
}

TEST(RankSum, HoldsItsLevelUnderTheHypothesis) {
  int rejected = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed)
    rejected += rank_sum_test(normals(20, 2 * seed), normals(25, 2 * seed + 1)).p_value <= 0.05;
  EXPECT_NEAR(rejected, 100, 4 * std::sqrt(95.0));
}

// The brute-force twin: every one of the 2^n patterns of signs.
double exact_by_enumeration(const Sample& differences) {
  const Ranks ranks = midranks([&] {
    Sample sizes;
    for (const double d : differences) sizes.push_back(std::abs(d));
    return sizes;
  }());
  const std::size_t n = differences.size();
  const double mean = static_cast<double>(n * (n + 1)) / 4;
  double observed = 0;
  for (std::size_t i = 0; i < n; ++i) observed += differences[i] > 0 ? ranks.rank[i] : 0;
  std::uint32_t as_extreme = 0;
  for (std::uint32_t pattern = 0; pattern < 1U << n; ++pattern) {
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += (pattern >> i & 1U) != 0 ? ranks.rank[i] : 0;
    as_extreme += std::abs(sum - mean) >= std::abs(observed - mean);
  }
  return static_cast<double>(as_extreme) / static_cast<double>(1U << n);
}

TEST(SignedRank, ExactEqualsEnumeration) {
  for (std::size_t n = 1; n <= 12; ++n) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const Sample x = normals(n, seed, 0.4);
      const SignedRank test = signed_rank_test(x, Sample(n, 0.0));
      EXPECT_TRUE(test.exact);
      EXPECT_NEAR(test.p_value, exact_by_enumeration(x), 1e-15) << n << " pairs, seed " << seed;
    }
  }
}

TEST(SignedRank, AllOfOneSignByHand) {
  const Sample rise = {1, 2, 3, 4, 5, 6};
  const SignedRank test = signed_rank_test(rise, Sample(6, 0.0));
  EXPECT_EQ(test.statistic, 0);
  EXPECT_DOUBLE_EQ(test.p_value, 2.0 / 64);
}

TEST(SignedRank, FiftyPairsAreExactAndFiftyOneAreNot) {
  const SignedRank fifty = signed_rank_test(normals(50, 1), Sample(50, 0.0));
  const SignedRank more = signed_rank_test(normals(51, 1), Sample(51, 0.0));
  EXPECT_TRUE(fifty.exact);
  EXPECT_FALSE(more.exact);
  Sample all_positive(50);
  for (std::size_t i = 0; i < 50; ++i) all_positive[i] = static_cast<double>(i + 1);
  EXPECT_DOUBLE_EQ(signed_rank_test(all_positive, Sample(50, 0.0)).p_value, std::ldexp(1.0, -49));
}

TEST(SignedRank, TiesTakeTheCorrectedNormalApproximation) {
  const SignedRank test = signed_rank_test(Sample{1, -1, 2, 2, 2}, Sample(5, 0.0));
  EXPECT_FALSE(test.exact);
  EXPECT_EQ(test.statistic, 1.5);
  const double variance = (5 * 6 * 11 - (6 + 24) / 2.0) / 24;
  EXPECT_NEAR(test.p_value, std::erfc((7.5 - 1.5) / std::sqrt(2 * variance)), 1e-15);
}

TEST(SignedRank, EqualAndUndefinedPairsAreLeftOut) {
  const SignedRank test = signed_rank_test(Sample{1, 5, kNan, -2, 3, 4}, Sample{0, 5, 1, 0, 0, kNan});
  EXPECT_EQ(test.n, 3);
  EXPECT_EQ(test.n_equal, 1);
  EXPECT_FALSE(test.exact);
  EXPECT_EQ(test.statistic, 2);
}

TEST(SignedRank, PairsOfInfinityAreEqual) {
  const double infinity = std::numeric_limits<double>::infinity();
  const SignedRank test =
      signed_rank_test(Sample{infinity, -infinity, 3, infinity}, Sample{infinity, -infinity, 2, 1});
  EXPECT_EQ(test.n_equal, 2);
  EXPECT_EQ(test.n, 2);
  EXPECT_EQ(test.statistic, 0);
}

TEST(Midranks, RefuseNan) { EXPECT_THROW(midranks(Sample{1, kNan, 2}), std::logic_error); }

TEST(SignedRank, WithoutPairsIsUndefinedAndWithEqualOnesCertain) {
  EXPECT_TRUE(std::isnan(signed_rank_test(Sample{}, Sample{}).p_value));
  EXPECT_TRUE(std::isnan(signed_rank_test(Sample{kNan}, Sample{1}).p_value));
  EXPECT_EQ(signed_rank_test(Sample{1, 2}, Sample{1, 2}).p_value, 1);
}

TEST(SignedRank, RefusesSamplesOfDifferentLength) {
  EXPECT_THROW(signed_rank_test(Sample{1, 2}, Sample{1}), std::logic_error);
}

}  // namespace
}  // namespace salbench
