// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/by_matching.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(ChosenMetrics, ComeInTheOrderOfTheTable) {
  const std::vector<Metric> chosen = chosen_metrics({.names = {"kl", "nss", "cc_area"}});
  EXPECT_THAT(chosen, ElementsAre(testing::Field(&Metric::name, "nss"), testing::Field(&Metric::name, "kl"),
                                  testing::Field(&Metric::name, "cc_area")));
  EXPECT_TRUE(any_reads(chosen, Reads::areas));
  EXPECT_FALSE(any_reads(chosen_metrics({}), Reads::areas));
  EXPECT_THROW(chosen_metrics({.names = {"nss", "no_such"}}), OptionError);
}

TEST(ChosenMetrics, HaveTheMatchingAndTheVersionOfTheirReading) {
  const auto version = [](const std::vector<std::string>& names, const ByName<Matching>& matching,
                          double floor = 0) {
    return scores_version(chosen_metrics({.names = names, .matching = matching, .floor = floor}));
  };
  EXPECT_EQ(scores_version(chosen_metrics({})), 4) << "of those that draw";
  EXPECT_EQ(version({"auc_exact", "nss", "cc", "lcc"}, {}), 1);
  EXPECT_EQ(version({"nss", "kl"}, {}), 3);
  EXPECT_EQ(version({"nss", "kl"}, {{"kl", Matching::histogram}}), 1);
  EXPECT_EQ(version({"nss"}, {{"nss", Matching::none}}), 3);
  EXPECT_EQ(version({"cc"}, {{"kl", Matching::none}}), 1);
  EXPECT_EQ(version({"sim"}, {}, 0.1), 3);
  EXPECT_EQ(version({"sim"}, {{"sim", Matching::raw}}, 0.1), 5);
}

TEST(MetricsByMatching, ScoresEachPartOnceAndKeepsTheOrder) {
  const MetricsByMatching metrics({.names = {"nss", "ig", "spearman", "kl", "lcc"}});
  int calls = 0;
  const Scores scores = metrics.score([&](std::span<const Metric> part, Matching matching) {
    ++calls;
    Scores of_part{{}, 7, 3};
    for (const Metric& metric : part) {
      EXPECT_EQ(metric.matching, matching);
      of_part.values.push_back(static_cast<double>(metric.name.size()));
    }
    return of_part;
  });
  EXPECT_EQ(calls, 2);
  EXPECT_EQ(scores.values, (std::vector<double>{3, 3, 2, 8, 2}));
  EXPECT_EQ(scores.n_points, 7);
  EXPECT_EQ(scores.n_picks, 3);
  EXPECT_FALSE(MetricsByMatching({}).any(Matching::none));
}

}  // namespace
}  // namespace salbench
