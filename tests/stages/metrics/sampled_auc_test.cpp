// SPDX-License-Identifier: GPL-3.0-or-later
// Areas over random negatives, against a reference that counts pairs at each point of the curve.
#include <functional>

#include "stages/core/field.h"
#include "stages/metrics/roc.h"
#include "stages/metrics/score.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

// Area of one split: sum over neighbouring thresholds, from below all values to above all.
double area(ScalarField picks, ScalarField negatives, const ScalarField& thresholds) {
  std::ranges::sort(picks);
  std::ranges::sort(negatives);
  const auto rate = [](const ScalarField& values, double threshold) {
    return static_cast<double>(values.end() - std::ranges::lower_bound(values, threshold)) /
           static_cast<double>(values.size());
  };
  ScalarField all = thresholds;
  all.insert(all.begin(), -HUGE_VAL);
  all.push_back(HUGE_VAL);
  double sum = 0;
  for (std::size_t k = 1; k < all.size(); ++k)
    sum += (rate(negatives, all[k - 1]) - rate(negatives, all[k])) *
           (rate(picks, all[k - 1]) + rate(picks, all[k])) / 2;
  return sum;
}

double twin(const ScalarField& picks, const Splits& splits, const ScalarField& fixed,
            const std::function<double()>& negative) {
  double sum = 0;
  for (int split = 0; split < splits.count; ++split) {
    ScalarField negatives, thresholds = fixed;
    for (std::size_t k = 0; k < picks.size(); ++k) negatives.push_back(negative());
    const double largest = std::max(std::ranges::max(picks), std::ranges::max(negatives));
    for (int k = 0; fixed.empty() && k < splits.thresholds; ++k)
      thresholds.push_back(k + 1 < splits.thresholds ? largest * k / (splits.thresholds - 1) : largest);
    sum += area(picks, negatives, thresholds);
  }
  return sum / splits.count;
}

// Few levels, so that values tie with thresholds; many small ones; values below zero, where even thresholds
// do not ascend; subnormal values.
TEST(SampledAuc, EqualsTheTwin) {
  Rng rng(7, "suite", "");
  for (int repeat = 0; repeat < 60; ++repeat) {
    ScalarField map(2 + rng.below(repeat % 6 == 0 ? 400 : 12));
    const double levels = repeat % 2 == 0 ? 8 : 1e9, power = repeat % 3 == 0 ? 4 : 1,
                 shift = repeat % 5 == 0   ? -2
                         : repeat % 7 == 0 ? -0.5
                                           : 0,
                 scale = repeat % 11 == 0 ? 5e-324 : 1;
    for (double& value : map)
      value = (std::pow(std::round(rng.uniform() * levels) / levels, power) + shift) * scale;
    ScalarField picks(1 + rng.below(40));
    for (double& pick : picks) pick = map[rng.below(map.size())];
    const Splits splits{5, 2 + static_cast<std::int32_t>(rng.below(20))};
    const Rng draws(1, "scores", std::to_string(repeat));
    Rng same = draws;
    RandomValues values = values_at_random_points(map, draws);
    EXPECT_EQ(sampled_auc(picks, values, splits),
              twin(picks, splits, {}, [&] { return map[same.below(map.size() - 1) + 1]; }));
    ScalarField tenths;
    const auto [least, largest] = std::ranges::minmax(map);
    for (int k = 0; k <= 10; ++k) tenths.push_back(least + (largest - least) * k / 10);
    EXPECT_EQ(tenths_of_range(map), tenths);
    ScalarField sorted = map;
    std::ranges::sort(sorted);
    RandomValues quantiles = random_quantiles(sorted, draws);  // shared by curves of fewer and of more picks
    for (const std::size_t count : {picks.size() / 2 + 1, picks.size()})
      for (const ScalarField& thresholds : {ScalarField{}, tenths}) {
        const ScalarField some(picks.begin(), picks.begin() + static_cast<std::ptrdiff_t>(count));
        same = draws;
        EXPECT_EQ(sampled_auc(some, quantiles, splits, thresholds), twin(some, splits, thresholds, [&] {
                    const double u = same.uniform(), n = static_cast<double>(sorted.size());
                    return sorted[static_cast<std::size_t>(std::floor(u * n))];
                  }));
      }
  }
}

// The paper's, of random points and even thresholds; Borji's, of quantiles and tenths of the range.
TEST(SampledAuc, OfTheTableIsThatOfPicksDrawnOnceEach) {
  Rng rng(8, "suite", "");
  for (int repeat = 0; repeat < 20; ++repeat) {
    ScalarField map(2 + rng.below(60));
    for (double& value : map) value = std::round(rng.uniform() * 50) / 50;
    GroundTruth truth{map, {{}}};
    for (std::uint64_t k = 1 + rng.below(40); k > 0; --k)
      truth.picks[0].push_back(static_cast<std::int32_t>(rng.below(map.size())));
    const MetricsOptions options{.splits = 3, .thresholds = 7, .names = {"auc", "auc_borji"}};
    const Rng draws(1, "scores", std::to_string(repeat));
    ScalarField sorted = map, picks;
    std::ranges::sort(sorted);
    for (const std::int32_t pick : picked_points(truth)) picks.push_back(map[index(pick)]);
    RandomValues values = values_at_random_points(map, draws), quantiles = random_quantiles(sorted, draws);
    EXPECT_THAT(score(map, truth, options, draws).values,
                testing::ElementsAre(sampled_auc(picks, values, {3, 7}),
                                     sampled_auc(picks, quantiles, {3, 7}, tenths_of_range(map))));
  }
}

TEST(SampledAuc, IsUndefinedWithoutPicksOrNegatives) {
  const Splits splits{3, 4};
  const Rng draws(1, "scores", "x");
  const ScalarField map = {1, 2, 3}, one = {1}, none;
  RandomValues of_three = values_at_random_points(map, draws), of_one = values_at_random_points(one, draws),
               of_none = random_quantiles(none, draws);
  EXPECT_TRUE(std::isnan(sampled_auc(none, of_three, splits)));
  EXPECT_TRUE(std::isnan(sampled_auc(ScalarField{1}, of_one, splits)));
  EXPECT_TRUE(std::isnan(sampled_auc(map, of_none, splits, tenths_of_range(none))));
}

}  // namespace
}  // namespace salbench
