// SPDX-License-Identifier: GPL-3.0-or-later
// Sampled areas under curves: draws, tables of thresholds, and the curves that share them.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "stages/metrics/comparison.h"
#include "stages/metrics/quantile_roc.h"
#include "stages/metrics/threshold_table.h"

namespace salbench {
namespace {

TEST(Draws, AreThoseOfTheGenerator) {
  const Rng rng(9, "suite", "");
  Draws draws(rng);
  for (const std::size_t count : {3U, 10U, 4U, 500U})
    for (const std::uint32_t bound : {7U, 4000000000U}) {
      Rng below = rng, next = rng, uniform = rng;
      for (const std::uint32_t drawn : draws.below(bound, count)) ASSERT_EQ(drawn, below.below(bound));
      for (const std::uint64_t number : draws.numbers(count)) {
        ASSERT_EQ(number, next.next());
        ASSERT_EQ(uniform_of(number), uniform.uniform());
      }
    }
}

// One number in 2^32 is rejected at most: the first of this stream is, for the bound below which most are.
TEST(Draws, GoOnBehindANumberThatIsRejected) {
  constexpr std::uint32_t kBound = 4294901761U;
  const Rng rng(269845303, "draws", "");
  ASSERT_LT(Rng(rng).next(), (0 - std::uint64_t{kBound}) % kBound);
  for (const std::size_t count : {1U, 2U, 9U}) {
    Draws draws(rng);
    Rng below = rng;
    for (const std::uint32_t drawn : draws.below(kBound, count)) EXPECT_EQ(drawn, below.below(kBound));
    for (const std::uint32_t drawn : draws.below(kBound, count + 1).last(1))
      EXPECT_EQ(drawn, below.below(kBound));
  }
}

TEST(ThresholdTable, CountsAsASearchDoes) {
  Rng rng(8, "suite", "");
  for (int repeat = 0; repeat < 200; ++repeat) {
    ScalarField positions(rng.below(50));
    for (double& position : positions) {  // on borders of cells, equal, close together, at the ends
      const double cell = static_cast<double>(rng.below(65)) / 64;
      position = std::min(1.0, rng.below(2) == 0 ? cell : cell + rng.uniform() / 1000);
    }
    std::ranges::sort(positions);
    const ThresholdTable table(positions, rng.below(600));
    const ThresholdTable::LookUp reached = table.look_up();
    for (int k = 0; k < 500; ++k) {
      const std::uint64_t number = rng.below(4) == 0 ? rng.below(64) << 58U : rng.next();
      ASSERT_EQ(reached(number), std::ranges::upper_bound(positions, uniform_of(number)) - positions.begin());
    }
  }
}

TEST(EvenThresholds, CountAsASearchDoes) {
  Rng rng(11, "suite", "");
  for (const double largest : {5e-324, 1e-300, 0.3, 1.0, 1e300}) {
    for (const std::int32_t count : {2, 3, 20, 1000}) {
      const std::vector<double> thresholds = even_thresholds(count, largest);
      const EvenThresholds table(thresholds, largest);
      ScalarField values = {0, largest};
      for (int k = 0; k < 200; ++k) {
        const double threshold = thresholds[rng.below(thresholds.size())];
        for (const double value : {largest * rng.uniform(), threshold, std::nextafter(threshold, 0.0),
                                   std::min(std::nextafter(threshold, 2 * largest), largest)})
          values.push_back(value);
      }
      for (const double value : values)
        ASSERT_EQ(table.look_up()(value), std::ranges::upper_bound(thresholds, value) - thresholds.begin())
            << value << " of " << largest;
    }
  }
}

TEST(SampledAuc, OfACurveDoesNotDependOnTheOthersBesideIt) {
  Rng rng(7, "suite", "");
  for (const double shift : {0.0, -2.0}) {  // below zero, thresholds do not ascend
    ScalarField map(400), areas;
    for (double& value : map) value = std::pow(rng.uniform(), 4) + shift;
    for (std::size_t i = 0; i < map.size(); ++i) areas.push_back(rng.uniform());
    const ScalarField picks = {map[7], map[9], map[9], map[255]};
    Draws draws(Rng(1, "scores", "x"));
    const Measures measures(map.size(), areas);
    const Comparison comparison({.map = map, .measures = measures}, draws);
    const std::vector<QuantileCurve> curves = {
        {comparison.map_distribution(Weighting::vertex), Thresholds::tenths},
        {comparison.map_distribution(Weighting::area), Thresholds::even},
        {comparison.map_distribution(Weighting::area), Thresholds::tenths}};
    const std::vector<double> together = quantile_aucs(curves, picks, draws, {100, 20});
    for (std::size_t c = 0; c < curves.size(); ++c)
      EXPECT_EQ(quantile_aucs({&curves[c], 1}, picks, draws, {100, 20}).front(), together[c]);
  }
}

TEST(Comparison, AreasAreThoseOfTheSplitsAskedFor) {
  ScalarField map(50);
  Rng rng(10, "suite", "");
  for (double& value : map) value = rng.uniform();
  const std::vector<std::int32_t> picked = {3, 8, 30};
  const Measures measures(map.size(), {});
  Draws draws(rng);
  const Comparison fresh({.map = map, .measures = measures}, draws), used = fresh;
  const Splits few{3, 2}, many{100, 20};
  const double area = used.sampled_auc(picked, many), tenths = used.quantile_areas(picked, many).tenths[0];
  EXPECT_NE(used.sampled_auc(picked, few), area);
  EXPECT_EQ(used.sampled_auc(picked, few), fresh.sampled_auc(picked, few));
  EXPECT_NE(used.quantile_areas(picked, few).tenths[0], tenths);
  EXPECT_EQ(used.quantile_areas(picked, few).tenths[0], fresh.quantile_areas(picked, few).tenths[0]);
}

}  // namespace
}  // namespace salbench
