// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/field.h"
#include "stages/metrics/score.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(Unmatched, AMapBelow0IsNoDensityUnlessItIsShifted) {
  const ScalarField below{0.25, -0.5, std::nan(""), 1}, above{0.25, 0.5, 1, 4};
  EXPECT_EQ(unmatched(above, Matching::raw), above);
  EXPECT_EQ(unmatched(above, Matching::shifted), above) << "its least value is no zero";
  EXPECT_EQ(unmatched(below, Matching::shifted), (ScalarField{0.75, 0, 0.5, 1.5}));
  EXPECT_EQ(unmatched(below, Matching::none), min_max_normalised(below));
  EXPECT_THROW(unmatched(below, Matching::raw), InputError);
  EXPECT_THROW(unmatched(ScalarField{HUGE_VAL}, Matching::raw), InputError);
  EXPECT_EQ(unmatched(ScalarField{}, Matching::shifted), ScalarField{});
}

// Raw maps have a unit; a map in [0, 1] has none.
TEST(Floor, RaisesMapsInTheUnitIntervalAlone) {
  const GroundTruth truth{{0, 1, 2, 3}, {{3}}};
  for (const std::string name : {"kl", "sim", "sim_minmax", "ig"})
    for (const Matching reading : {Matching::none, Matching::histogram, Matching::raw, Matching::shifted}) {
      const auto of = [&](double unit, double floor) {
        const MetricsOptions options{.names = {name}, .matching = {{name, reading}}, .floor = floor};
        const ScalarField map = unmatched(ScalarField{0, unit, 4 * unit, 3 * unit}, reading);
        return score(map, truth, options, Rng(1, "scores", "x")).values[0];
      };
      EXPECT_EQ(of(1, 0.5), of(0.125, 0.5)) << name << ", read as " << name_of(reading);
      const bool in_unit_interval = is_normalised(reading) || name == "sim_minmax";
      EXPECT_EQ(of(1, 0.5) != of(1, 0), in_unit_interval) << name << ", read as " << name_of(reading);
    }
}

TEST(InRange, IsEveryScoreThatIsShown) {
  const auto with = [](double value) {
    return in_range(chosen_metrics({.names = {"nss", "cc", "lcc"}}), {{value, value, value}});
  };
  const double above = std::nextafter(1.0, 2.0);
  EXPECT_EQ(with(above).values, (std::vector<double>{above, 1, 1}));
  EXPECT_EQ(with(-above).values, (std::vector<double>{-above, -1, 0}));
  EXPECT_EQ(with(0.25).values, std::vector<double>(3, 0.25));
  EXPECT_TRUE(std::ranges::all_of(with(std::nan("")).values, [](double value) { return std::isnan(value); }));
}

TEST(Score, RefusesGroundTruthOfAnotherShape) {
  const Rng rng(1, "score", "x");
  EXPECT_THROW(score({1, 2, 3}, {{1, 2}, {}}, {}, rng), InputError);
  EXPECT_THROW(score({1, 2, 3}, {{1, 2, 3}, {{3}}}, {}, rng), InputError);
  EXPECT_THROW(score({1, 2, 3}, {{1, 2, 3}, {{-1}}}, {}, rng), InputError);
}

TEST(MetricTable, HasTheColumnsOfStoredScoresInTheirOrder) {
  std::vector<std::string_view> names;
  for (const Metric& metric : metric_table()) {
    names.push_back(metric.name);
    EXPECT_FALSE(metric.unit.empty() || metric.help.empty()) << metric.name;
    EXPECT_LE(metric.since, scores_version(metric_table())) << metric.name;
  }
  names.resize(5);  // others follow
  EXPECT_EQ(names, (std::vector<std::string_view>{"auc", "auc_exact", "nss", "cc", "lcc"}));
  EXPECT_THROW(value_of(Scores{}, "no such metric"), std::out_of_range);
  EXPECT_THROW(value_of(Scores{}, "auc"), std::out_of_range);
}

TEST(MetricTable, ANewMetricIsAFunctionAndARow) {
  std::vector<Metric> metrics = chosen_metrics({});
  metrics.push_back({.name = "picked_mean", .value = [](const MetricInput& in) {
                       double sum = 0;
                       for (const std::int32_t i : in.picked) sum += in.map[index(i)];
                       return sum / static_cast<double>(in.picked.size());
                     }});
  const GroundTruth truth{{1, 3, 2, 0}, {{1, 2}, {2}}};
  const Rng rng(1, "score", "x");
  const Scores with = score(metrics, ScalarField{1, 5, 2, 0}, truth, {}, rng, {.size = 4});
  const Scores without = score({1, 5, 2, 0}, truth, {}, rng);
  ASSERT_EQ(with.values.size(), without.values.size() + 1);
  EXPECT_EQ(with.values.back(), 3.5);
  for (std::size_t m = 0; m < without.values.size(); ++m) EXPECT_EQ(with.values[m], without.values[m]) << m;
}

}  // namespace
}  // namespace salbench
