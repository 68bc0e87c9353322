// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/by_matching.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(ChosenMetrics, ComeInTheOrderOfTheTable) {
  MetricsOptions options;
  options.names = {"kl", "nss", "cc_area"};
  std::vector<std::string> names;
  for (const Metric& metric : chosen_metrics(options)) names.push_back(metric.name);
  EXPECT_EQ(names, (std::vector<std::string>{"nss", "kl", "cc_area"}));
  EXPECT_TRUE(any_reads(chosen_metrics(options), Reads::areas));
  EXPECT_FALSE(any_reads(chosen_metrics({}), Reads::areas));
  options.names = {"nss", "no_such"};
  EXPECT_THROW(chosen_metrics(options), OptionError);
}

TEST(ChosenMetrics, HaveTheMatchingAndTheVersionOfTheirReading) {
  const auto version = [](const std::vector<std::string>& names, const ByName<Matching>& matching) {
    MetricsOptions options;
    options.names = names;
    options.matching = matching;
    return scores_version(chosen_metrics(options));
  };
  EXPECT_EQ(scores_version(chosen_metrics({})), 4) << "of those that draw";
  EXPECT_EQ(version({"auc_exact", "nss", "cc", "lcc"}, {}), 1);
  EXPECT_EQ(version({"nss", "kl"}, {}), 3);
  EXPECT_EQ(version({"nss", "kl"}, {{"kl", Matching::histogram}}), 1);
  EXPECT_EQ(version({"nss"}, {{"nss", Matching::none}}), 3);
  EXPECT_EQ(version({"cc"}, {{"kl", Matching::none}}), 1);
  MetricsOptions floored{.names = {"sim"}, .floor = 0.1};
  EXPECT_EQ(scores_version(chosen_metrics(floored)), 3);
  floored.matching = {{"sim", Matching::raw}};
  EXPECT_EQ(scores_version(chosen_metrics(floored)), 5);
}

TEST(MetricsByMatching, ScoresEachPartOnceAndKeepsTheOrder) {
  MetricsOptions options;
  options.names = {"nss", "ig", "spearman", "kl", "lcc"};
  const MetricsByMatching metrics(options);
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
