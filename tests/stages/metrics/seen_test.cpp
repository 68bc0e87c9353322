// SPDX-License-Identifier: GPL-3.0-or-later
// Unseen points are excluded from all metrics.
#include "stages/core/seen.h"

#include "stages/core/field.h"
#include "tests/stages/metrics/complete.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

constexpr double kUnseen = kNan;

struct Example {
  ScalarField map, areas;
  GroundTruth truth;
};

Example random_example(std::size_t n) {
  Rng rng(1, "example", "");
  Example example;
  for (std::size_t i = 0; i < n; ++i) {
    example.map.push_back(rng.uniform());
    example.areas.push_back(0.5 + rng.uniform());
    example.truth.saliency.push_back(rng.uniform());
  }
  example.truth.picks = {{3, 4, 50}, {4, 99}, {}};
  return example;
}

TEST(UnseenPoints, TakeNoPartInAnyMetric) {
  const Example whole = random_example(100);
  Example masked = whole, seen;
  for (std::size_t i = 0; i < 100; ++i) {
    if (i % 3 == 0 || i == 50) {
      masked.truth.saliency[i] = kUnseen;
      masked.map[i] = 1e9;  // value of a model at an unseen point
    } else {
      seen.map.push_back(whole.map[i]);
      seen.areas.push_back(whole.areas[i]);
      seen.truth.saliency.push_back(whole.truth.saliency[i]);
    }
  }
  seen.truth.picks = {{2}, {2}, {}};  // point 4 is the third remaining one; 3, 50 and 99 are unseen
  // Areas also serve as the centre bias.
  const Measures of_all = complete_measures(100, whole.areas, whole.areas);
  const Rng draws(1, "scores", "x");
  const Scores of_masked = score(metric_table(), masked.map, masked.truth, {}, draws, of_all);
  const Scores of_seen =
      score(metric_table(), seen.map, seen.truth, {}, draws, of_all.at(*seen_points(masked.truth.saliency)));
  EXPECT_EQ(of_masked.values, of_seen.values);
  for (const double value : of_masked.values) EXPECT_TRUE(std::isfinite(value));
  EXPECT_EQ(of_masked.n_points, static_cast<std::int64_t>(seen.map.size()));
  EXPECT_EQ(of_masked.n_picks, 1);
}

TEST(UnseenPoints, WhereThereIsNothingElseEveryMetricIsUndefined) {
  const GroundTruth truth{{kUnseen, kUnseen}, {{0}}};
  const Scores scores = score(metric_table(), ScalarField{1, 2}, truth, {}, Rng(1, "", ""), {.size = 2});
  EXPECT_THAT(scores.values, Each(IsNan()));
  EXPECT_EQ(scores.n_points, 0);
  EXPECT_EQ(scores.n_picks, 0);
}

TEST(SeenPoints, AreThoseWithAValue) {
  EXPECT_EQ(seen_points(ScalarField{0, -1, 2}), std::nullopt);
  EXPECT_EQ(seen_points(ScalarField{}), std::nullopt);
  EXPECT_THAT(*seen_points(ScalarField{kUnseen, 5, kUnseen, 0}), ElementsAre(1, 3));
  EXPECT_THAT(values_at(ScalarField{7, 8, 9}, std::vector<std::int32_t>{0, 2}), ElementsAre(7, 9));
}

TEST(MeanOfSeen, IsOverThoseThatSawThePoint) {
  const std::vector<ScalarField> maps = {{1, kUnseen, kUnseen}, {100, 100, 100}, {3, 4, kUnseen}};
  for (const std::vector<std::size_t>& members : {std::vector<std::size_t>{0, 2}, {2, 0}})
    EXPECT_THAT(mean_of_seen(maps, members), ElementsAre(2, 4, IsNan()));
}

}  // namespace
}  // namespace salbench
