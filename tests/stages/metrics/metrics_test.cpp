// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/metrics.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "stages/core/field.h"

namespace salbench {
namespace {

struct Example {
  ScalarField map;
  std::vector<std::int32_t> picked;
};

// Values with many ties where `levels` is small; larger ones are picked more often.
Example random_example(std::size_t n, int levels, std::uint64_t seed) {
  Rng rng(seed, "example", "");
  Example example;
  for (std::size_t i = 0; i < n; ++i) {
    example.map.push_back(std::floor(levels * rng.uniform()) / levels);
    if (rng.uniform() < 0.05 + 0.3 * example.map.back())
      example.picked.push_back(static_cast<std::int32_t>(i));
  }
  return example;
}

ScalarField values_at(const ScalarField& map, const std::vector<std::int32_t>& picked) {
  ScalarField values;
  for (const std::int32_t i : picked) values.push_back(map[static_cast<std::size_t>(i)]);
  return values;
}

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

// The protocol as it reads: every rate by counting.
double auc_by_counting(const Example& example, const MetricsOptions& options, Rng rng) {
  const auto rate = [](const ScalarField& values, double threshold) {
    return static_cast<double>(std::ranges::count_if(values, [&](double v) { return v >= threshold; })) /
           static_cast<double>(values.size());
  };
  const ScalarField positives = values_at(example.map, example.picked);
  double sum = 0;
  for (int split = 0; split < options.splits; ++split) {
    ScalarField negatives;
    for (std::size_t k = 0; k < positives.size(); ++k)
      negatives.push_back(example.map[1 + rng.below(example.map.size() - 1)]);
    const double largest = std::max(std::ranges::max(positives), std::ranges::max(negatives));
    std::vector<std::pair<double, double>> curve = {{1, 1}};
    for (int t = 0; t < options.thresholds; ++t) {
      const double threshold = t == options.thresholds - 1 ? largest : largest * t / (options.thresholds - 1);
      curve.emplace_back(rate(negatives, threshold), rate(positives, threshold));
    }
    curve.emplace_back(0, 0);
    for (std::size_t k = 1; k < curve.size(); ++k)
      sum += (curve[k - 1].first - curve[k].first) * (curve[k - 1].second + curve[k].second) / 2;
  }
  return sum / options.splits;
}

TEST(Auc, EqualsTheProtocolByCounting) {
  for (const int levels : {4, 1000}) {
    const Example example = random_example(400, levels, 61);
    Example of_both_signs = example, negative = example, low = example;
    for (double& value : of_both_signs.map) value -= 0.5;
    for (double& value : negative.map) value -= 2;
    low.picked = {static_cast<std::int32_t>(std::ranges::min_element(low.map) - low.map.begin())};
    for (const Example& each : {example, of_both_signs, negative, low}) {
      for (const MetricsOptions& options : {MetricsOptions{}, MetricsOptions{7, 2}}) {
        const Rng rng(1, "score", "x");
        EXPECT_NEAR(auc(each.map, each.picked, options, rng), auc_by_counting(each, options, rng), 1e-12);
      }
    }
  }
}

TEST(Auc, OfTwoPointsIsKnown) {
  const std::vector<std::int32_t> first = {0};  // the only negative is then the second point
  const Rng rng(1, "score", "x");
  EXPECT_DOUBLE_EQ(auc(ScalarField{1, 0}, first, {}, rng), 1);
  EXPECT_DOUBLE_EQ(auc(ScalarField{0, 1}, first, {}, rng), 0);
}

TEST(Auc, NeverDrawsTheFirstPointAsANegative) {
  // The pick meets itself in one draw of 49, a tie, and beats all others. Were the first point drawn too, it
  // would win one draw of 50 and pull the area down to 0.97.
  ScalarField map(50, 0.1);
  map[0] = 9;
  map[7] = 0.2;
  const std::vector<std::int32_t> picked = {7};
  EXPECT_NEAR(auc(map, picked, {10000, 20}, Rng(1, "score", "x")), 1 - 0.5 / 49, 0.004);
}

TEST(Auc, DependsOnItsRandomNumbersAlone) {
  const Example example = random_example(300, 1000, 63);
  const auto with = [&](std::uint64_t seed) {
    return auc(example.map, example.picked, {}, Rng(seed, "score", "x"));
  };
  EXPECT_EQ(with(1), with(1));
  EXPECT_NE(with(1), with(2));
}

TEST(AucExact, SeesTheOrderAlone) {
  const Example example = random_example(500, 50, 65);
  ScalarField stretched = example.map, mirrored = example.map;
  for (double& value : stretched) value = std::exp(3 * value);
  for (double& value : mirrored) value = -value;
  const double exact = auc_exact(example.map, example.picked);
  EXPECT_DOUBLE_EQ(auc_exact(stretched, example.picked), exact);
  EXPECT_NEAR(auc_exact(mirrored, example.picked), 1 - exact, 1e-12);
}

TEST(AucExact, WithoutBothKindsIsUndefined) {
  EXPECT_TRUE(std::isnan(auc_exact(ScalarField{1, 2}, {})));
  EXPECT_TRUE(std::isnan(auc_exact(ScalarField{1, 2}, std::vector<std::int32_t>{0, 1})));
}

TEST(Nss, CountsDeviationsAboveTheMean) {
  const ScalarField map = {0, 0, 0, 4};  // mean 1, deviation sqrt(3)
  EXPECT_NEAR(nss(map, std::vector<std::int32_t>{3}), 3 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(nss(map, std::vector<std::int32_t>{0, 3}), 1 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(nss(map, std::vector<std::int32_t>{0, 1, 2, 3}), 0, 1e-12);
  EXPECT_EQ(nss(ScalarField{2, 2, 2}, std::vector<std::int32_t>{1}), 0);
  EXPECT_EQ(nss(ScalarField{2, 2, 2}, std::vector<std::int32_t>{1}, -0.5), -0.5);
  EXPECT_TRUE(std::isnan(nss(map, {})));
}

TEST(Cc, IsThePearsonCorrelation) {
  EXPECT_NEAR(cc(ScalarField{1, 2, 3}, ScalarField{10, 20, 30}), 1, 1e-12);
  EXPECT_NEAR(cc(ScalarField{1, 2, 3}, ScalarField{3, 2, 1}), -1, 1e-12);
  EXPECT_NEAR(cc(ScalarField{1, 2, 3, 4}, ScalarField{1, -1, -1, 1}), 0, 1e-12);
  EXPECT_NEAR(cc(ScalarField{1, 2, 3}, ScalarField{1, 3, 2}), 0.5, 1e-12);
  EXPECT_EQ(cc(ScalarField{5, 5, 5}, ScalarField{1, 2, 3}), 0);
  EXPECT_EQ(cc(ScalarField{1, 2, 3}, ScalarField{0.1, 0.1, 0.1}), 0);
  EXPECT_TRUE(std::isnan(cc({}, {})));
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

TEST(Score, CountsAPointOnceWhoeverPickedIt) {
  const ScalarField map = {0, 0, 0, 4, 1};
  const GroundTruth often{{0, 0, 0, 1, 0}, {{3}, {3, 0}, {3, 3}}};
  const GroundTruth once{{0, 0, 0, 1, 0}, {{0, 3}}};
  const Scores a = score(map, often, {}, Rng(1, "score", "x"));
  const Scores b = score(map, once, {}, Rng(1, "score", "x"));
  EXPECT_EQ(a.n_picks, 2);
  EXPECT_EQ(a.n_points, 5);
  EXPECT_EQ(value_of(a, "nss"), value_of(b, "nss"));
  EXPECT_EQ(value_of(a, "auc"), value_of(b, "auc"));
  EXPECT_EQ(value_of(a, "auc_exact"), value_of(b, "auc_exact"));
  EXPECT_EQ(value_of(a, "cc"), cc(map, often.saliency));
  EXPECT_EQ(value_of(a, "lcc"), std::abs(value_of(a, "cc")));
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
  names.resize(5);  // others come behind
  EXPECT_EQ(names, (std::vector<std::string_view>{"auc", "auc_exact", "nss", "cc", "lcc"}));
  EXPECT_THROW(value_of(Scores{}, "no such metric"), std::out_of_range);
  EXPECT_THROW(value_of(Scores{}, "auc"), std::out_of_range);
}

TEST(MetricTable, ANewMetricIsAFunctionAndARow) {
  std::vector<Metric> metrics = chosen_metrics({});
  metrics.push_back(
      {"picked_mean", "Picked mean", "1", "mean of the map over the picks", [](const MetricInput& in) {
         double sum = 0;
         for (const std::int32_t i : in.picked) sum += in.map[static_cast<std::size_t>(i)];
         return sum / static_cast<double>(in.picked.size());
       }});
  const GroundTruth truth{{1, 3, 2, 0}, {{1, 2}, {2}}};
  const Rng rng(1, "score", "x");
  const Scores with = score(metrics, {1, 5, 2, 0}, truth, {}, rng);
  const Scores without = score({1, 5, 2, 0}, truth, {}, rng);
  ASSERT_EQ(with.values.size(), without.values.size() + 1);
  EXPECT_EQ(with.values.back(), 3.5);
  for (std::size_t m = 0; m < without.values.size(); ++m) EXPECT_EQ(with.values[m], without.values[m]) << m;
}

TEST(MetricTable, EveryMetricDrawsFromTheSameStream) {
  const Metric draw{"draw", "Draw", "1", "a random number", [](const MetricInput& in) {
                      Rng rng = in.rng;
                      return rng.uniform();
                    }};
  const std::vector<Metric> twice = {draw, draw};
  Rng rng(1, "score", "x");
  const Scores scores = score(twice, {1, 2}, {}, {}, rng);
  EXPECT_EQ(scores.values, std::vector<double>(2, rng.uniform()));
}

TEST(MetricsOptions, RefusesNoSplitsAndASingleThreshold) {
  EXPECT_NO_THROW(check(MetricsOptions{1, 2}));
  EXPECT_THROW(check(MetricsOptions{0, 20}), OptionError);
  EXPECT_THROW(check(MetricsOptions{100, 1}), OptionError);
  EXPECT_THROW(score({1, 2}, {{1, 2}, {{0}}}, MetricsOptions{0, 20}, Rng(1, "score", "x")), OptionError);
}

}  // namespace
}  // namespace salbench
