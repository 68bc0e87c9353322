// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stats/human_scale.h"

#include <cmath>

#include <gtest/gtest.h>

#include "stages/core/rng.h"
#include "stages/stats/distributions.h"
#include "stages/stats/summary.h"

namespace salbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double reached(const std::vector<double>& curve, double level) { return first_reached(curve, level, true); }

TEST(FirstReached, IsLinearBetweenTheNumbers) {
  const std::vector<double> curve{.5, .6, .65};
  EXPECT_DOUBLE_EQ(reached(curve, .525), 1.25);
  EXPECT_DOUBLE_EQ(reached(curve, .6), 2);
  EXPECT_DOUBLE_EQ(reached(curve, .64), 2.8);
}

TEST(FirstReached, EndsOfTheCurveAreOpen) {
  const std::vector<double> curve{.5, .6, .65};
  EXPECT_EQ(reached(curve, .499), -kInfinity);
  EXPECT_EQ(reached(curve, .5), 1);
  EXPECT_EQ(reached(curve, .65), 3);
  EXPECT_EQ(reached(curve, .651), kInfinity);
  EXPECT_EQ(reached({.5}, .5), 1);
}

TEST(FirstReached, OfACurveThatTurnsIsTheFewest) {
  const std::vector<double> hill{.5, .7, .6}, valley{.6, .5, .7}, falling{.7, .6, .5};
  EXPECT_DOUBLE_EQ(reached(hill, .65), 1.75);
  EXPECT_EQ(crossings(hill, .65), 2);
  EXPECT_EQ(reached(valley, .55), -kInfinity);
  EXPECT_EQ(crossings(valley, .55), 2);
  EXPECT_EQ(reached(falling, .65), -kInfinity);
  EXPECT_EQ(reached(falling, .75), kInfinity);
  EXPECT_EQ(crossings(falling, .75), 0);
  EXPECT_EQ(crossings(hill, .7), 0) << "touched, not passed";
  EXPECT_EQ(crossings(std::vector{.4, .5, .5, .6}, .5), 1);
}

// Turned upside down, lower is better.
TEST(FirstReached, FollowsTheDirectionOfTheMetric) {
  Rng rng(1, "curves", "");
  for (int round = 0; round < 200; ++round) {
    std::vector<double> curve(1 + rng.below(8)), turned;
    for (double& value : curve) value = rng.normal();
    for (const double value : curve) turned.push_back(-value);
    const double level = rng.normal();
    EXPECT_EQ(first_reached(curve, level, true), first_reached(turned, -level, false));
    EXPECT_EQ(crossings(curve, level), crossings(turned, -level));
  }
}

// Units that differ by a level of their own, a curve that rises by 1 - 1 / n of `gain`, and one model.
Columns units_of(std::size_t n, std::size_t length, double gain, double model, Rng& rng) {
  Columns scores{length + 1, {}};
  for (std::size_t unit = 0; unit < n; ++unit) {
    const double level = rng.normal();
    for (std::size_t i = 0; i < length; ++i)
      scores.values.push_back(level + gain * (1 - 1 / static_cast<double>(i + 1)) + .3 * rng.normal());
    scores.values.push_back(level + model + .5 * rng.normal());
  }
  return scores;
}

TEST(Equivalents, AModelOfTheCurveIsWorthThatMany) {
  Rng rng(1, "people", "");
  Columns scores = units_of(20, 5, 2, 0, rng);
  for (std::size_t unit = 0; unit < 20; ++unit)
    scores.values[unit * 6 + 5] = scores.at(unit, 2);  // the score of three
  const Equivalent found = equivalents(scores, Bootstrap(1, 2000).means(scores), 5, true)[0];
  EXPECT_EQ(found.participants, 3);
  EXPECT_EQ(found.crossings, 1);
  EXPECT_TRUE(std::isnan(found.interval.low)) << "three in every resample: no interval of width 0";
}

TEST(Equivalents, ManyUnitsShowTheTrueNumber) {
  Rng rng(2, "people", "");
  const Columns scores = units_of(2000, 6, 2, 1.25, rng);  // between 2 (1) and 3 (4 / 3)
  const Equivalent found = equivalents(scores, Bootstrap(1, 2000).means(scores), 6, true)[0];
  EXPECT_NEAR(found.participants, 2.75, .25);
  EXPECT_LT(found.interval.high - found.interval.low, .6);
}

TEST(Equivalents, BeyondTheCurveBothEndsAreOpen) {
  Rng rng(3, "people", "");
  for (const double model : {-40., 40.}) {
    const Columns scores = units_of(30, 4, 2, model, rng);
    const Equivalent found = equivalents(scores, Bootstrap(1, 500).means(scores), 4, true)[0];
    for (const double value : {found.participants, found.interval.low, found.interval.high})
      EXPECT_EQ(value, std::copysign(kInfinity, model));
  }
}

TEST(Equivalents, FewUnitsHaveNoInterval) {
  Rng rng(4, "people", "");
  for (const std::size_t n : {1UL, 2UL, kMinUnitsOfPercentiles - 1}) {
    const Columns scores = units_of(n, 3, 2, 1, rng);
    const Equivalent found = equivalents(scores, Bootstrap(1, 500).means(scores), 3, true)[0];
    EXPECT_FALSE(std::isnan(found.participants));
    EXPECT_TRUE(std::isnan(found.interval.low) && std::isnan(found.interval.high)) << n;
  }
}

// 95 % of the data sets, within what 400 of them can show; the standard error is 1.1 %.
TEST(Equivalents, TheIntervalHoldsTheTrueNumber) {
  constexpr int kDataSets = 400;
  int held = 0;
  for (int i = 0; i < kDataSets; ++i) {
    Rng rng(5, "people", std::to_string(i));
    const Columns scores = units_of(19, 6, 2, 1.25, rng);
    const Interval interval =
        equivalents(scores, Bootstrap(static_cast<std::uint64_t>(i), 1000).means(scores), 6, true)[0]
            .interval;
    held += interval.low <= 2.75 && 2.75 <= interval.high ? 1 : 0;
  }
  EXPECT_GE(held, .92 * kDataSets);
  EXPECT_LE(held, .98 * kDataSets);
}

// Models at a share of the way from chance to people, who differ from unit to unit.
Columns with_people(std::size_t n, const std::vector<double>& shares, double span, Rng& rng) {
  Columns scores{shares.size() + 2, {}};
  for (std::size_t unit = 0; unit < n; ++unit) {
    const double chance = 3 + .1 * rng.normal(), people = chance + span * (1 + .4 * rng.normal());
    for (const double share : shares)
      scores.values.push_back(3 + span * share + .25 * rng.normal() * std::abs(span));
    scores.values.insert(scores.values.end(), {chance, people});
  }
  return scores;
}

TEST(SharesOfPeople, AreTheRatioOfTheMeans) {
  const Columns scores{4, {.6, .9, .5, .7, .4, .9, .5, .7}};  // means .5, .9, .5, .7
  const std::vector<Share> shares = shares_of_people(scores, Bootstrap(1, 100).means(scores));
  EXPECT_NEAR(shares[0].value, 0, 1e-12);
  EXPECT_NEAR(shares[1].value, 2, 1e-12);
  EXPECT_TRUE(std::isnan(shares[0].interval.low)) << "two units";
}

TEST(SharesOfPeople, ChanceIsZeroAndPeopleAreOneWhoeverIsDrawn) {
  Rng rng(6, "shares", "");
  Columns scores = with_people(30, {0, 0}, 1, rng);
  for (std::size_t unit = 0; unit < 30; ++unit) {
    scores.values[unit * 4] = scores.at(unit, 2);
    scores.values[unit * 4 + 1] = scores.at(unit, 3);
  }
  const std::vector<Share> shares = shares_of_people(scores, Bootstrap(1, 500).means(scores));
  EXPECT_EQ(shares[0].value, 0);
  EXPECT_EQ(shares[1].value, 1);
  for (const Share& share : shares) EXPECT_TRUE(std::isnan(share.interval.low)) << "they do not vary";
}

// A metric in other units, or of which lower is better, has the same shares.
TEST(SharesOfPeople, DoNotDependOnTheScaleOfTheMetric) {
  Rng rng(7, "shares", "");
  const Columns scores = with_people(25, {.5, 1.2}, 1, rng);
  Columns turned = scores;
  for (double& value : turned.values) value = 5 - 8 * value;
  const auto a = shares_of_people(scores, Bootstrap(1, 500).means(scores)),
             b = shares_of_people(turned, Bootstrap(1, 500).means(turned));
  for (std::size_t m = 0; m < a.size(); ++m) {
    EXPECT_NEAR(a[m].value, b[m].value, 1e-9);
    EXPECT_NEAR(a[m].interval.low, b[m].interval.low, 1e-9);
    EXPECT_NEAR(a[m].interval.high, b[m].interval.high, 1e-9);
  }
}

// The share of which a paired t-test would not reject that the model is that share of the way ahead.
Interval fieller(const Columns& scores, std::size_t model) {
  const std::size_t chance = scores.count - 2;
  const auto n = static_cast<double>(scores.units());
  double x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  for (std::size_t u = 0; u < scores.units(); ++u) {
    x += (scores.at(u, model) - scores.at(u, chance)) / n;
    y += (scores.at(u, chance + 1) - scores.at(u, chance)) / n;
  }
  for (std::size_t u = 0; u < scores.units(); ++u) {
    const double dx = scores.at(u, model) - scores.at(u, chance) - x;
    const double dy = scores.at(u, chance + 1) - scores.at(u, chance) - y;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
  const double t = student_upper_quantile(.025, n - 1), c = t * t / (n * (n - 1));
  const double a = y * y - c * yy, b = x * y - c * xy, root = std::sqrt(b * b - a * (x * x - c * xx));
  return {(b - root) / a, (b + root) / a};
}

// Of normal scores the interval is Fieller's, but for the resamples: 10 000 of them know an end within some
// percent of the width. [fieller1954]
TEST(SharesOfPeople, HaveFiellersInterval) {
  for (const std::size_t n : {12UL, 19UL, 60UL}) {
    Rng rng(n, "shares", "");
    const Columns scores = with_people(n, {.4, 1.3}, 1, rng);
    const std::vector<Share> shares = shares_of_people(scores, Bootstrap(1).means(scores));
    for (std::size_t m = 0; m < 2; ++m) {
      const Interval exact = fieller(scores, m);
      const double width = exact.high - exact.low;
      EXPECT_NEAR(shares[m].interval.low, exact.low, .08 * width) << n;
      EXPECT_NEAR(shares[m].interval.high, exact.high, .08 * width) << n;
    }
  }
}

TEST(SharesOfPeople, TheIntervalHoldsTheTrueShare) {
  constexpr int kDataSets = 400;
  int held = 0;
  for (int i = 0; i < kDataSets; ++i) {
    Rng rng(8, "shares", std::to_string(i));
    const Columns scores = with_people(19, {.8}, 1, rng);
    const Interval interval =
        shares_of_people(scores, Bootstrap(static_cast<std::uint64_t>(i), 1000).means(scores))[0].interval;
    held += interval.low <= .8 && .8 <= interval.high ? 1 : 0;
  }
  EXPECT_GE(held, .92 * kDataSets);
  EXPECT_LE(held, .98 * kDataSets);
}

// People who are hardly ahead of chance leave the share open on the side of the model.
TEST(SharesOfPeople, WithoutASpanTheIntervalHasNoEnd) {
  Rng rng(9, "shares", "");
  Columns scores{3, {}};
  for (int unit = 0; unit < 20; ++unit) {
    const double chance = rng.normal();
    scores.values.insert(scores.values.end(), {chance + 5, chance, chance + .1 + rng.normal()});
  }
  const Share share = shares_of_people(scores, Bootstrap(1, 1000).means(scores))[0];
  EXPECT_EQ(std::abs(share.interval.high), kInfinity);
}

}  // namespace
}  // namespace salbench
