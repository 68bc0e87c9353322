// SPDX-License-Identifier: GPL-3.0-or-later
// The metrics beside the paper's: known answers, degenerate input, and that none depends on its company.
// Random cases against other implementations are in metrics_reference.py.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "stages/metrics/distribution.h"
#include "stages/metrics/metrics.h"
#include "stages/metrics/quantile_roc.h"
#include "stages/metrics/threshold_table.h"

namespace salbench {
namespace {

using Values = std::map<std::string, double>;

Values values_of(std::span<const Metric> metrics, const ScalarField& map, const GroundTruth& truth,
                 const ScalarField& areas) {
  MetricsOptions options;
  options.constant_nss = -0.5;
  ScalarField centre_bias;
  for (std::size_t i = 0; i < map.size(); ++i) centre_bias.push_back(static_cast<double>(i + 1));
  const Scores scores = score(metrics, map, truth, options, Rng(1, "scores", "x"), areas, centre_bias);
  Values values;
  for (std::size_t m = 0; m < metrics.size(); ++m) values[metrics[m].name] = scores.values[m];
  return values;
}

Values all_values(const ScalarField& map, const GroundTruth& truth) {
  return values_of(metric_table(), map, truth, ScalarField(map.size(), 0.5));
}

TEST(Order, AscendsAndKeepsTheIndicesOfEqualValues) {
  Rng rng(1, "order", "");
  for (const double scale : {1e-300, 1e-9, 1.0, 1e300}) {
    ScalarField field(3000);
    for (double& v : field)
      v = (rng.below(3) == 0 ? std::floor(rng.uniform() * 4) : rng.uniform() - 0.5) * scale;
    for (std::size_t i = 0; i < 500; ++i)
      field[i] = 1 + static_cast<double>(rng.below(100)) * 1e-15;  // one key
    field[7] = -0.0;
    field[9] = 0.0;
    Order expected(field.size());
    for (std::uint32_t i = 0; i < expected.size(); ++i) expected[i] = i;
    std::ranges::stable_sort(expected, {}, [&](std::uint32_t i) { return field[i]; });
    EXPECT_EQ(ascending_order(field), expected) << scale;
  }
  EXPECT_TRUE(ascending_order({}).empty());
}

// A NaN is not equal to itself: loops over equal values must not wait for it to be.
TEST(Order, RefusesNanAndRanksEndWhateverThereIs) {
  const double nan = std::nan("");
  for (const ScalarField& field : {ScalarField{nan}, {nan, 1, 2}, {1, 2, nan, 2}, {nan, nan}})
    EXPECT_THROW(ascending_order(field), std::logic_error);
  const ScalarField field = {1, nan, 2, nan};
  const Order order = {0, 2, 1, 3};
  EXPECT_EQ(mid_ranks(field, order, Measures(4, {})).by_vertex, (ScalarField{0.5, 2.5, 1.5, 3.5}));
  const Measures measures(4, {});
  const ScalarField map = {1, 2, 3, 4};
  const auto distribution = distributions(map, ascending_order(map), measures)[0];
  const Moments of_map = moments(map, measures)[0];
  for (const double auc : top_scores({map, distribution, of_map, field, order}, measures.vertex).auc)
    EXPECT_TRUE(std::isfinite(auc));
}

TEST(Order, PutsTheSmallestFirstHoweverManyThereAre) {
  Rng rng(2, "order", "");
  for (const std::size_t n : {1U, 2U, 600U, 3000U})
    for (const double zeros : {0.0, 0.5, 0.9, 1.0}) {
      ScalarField field(n);
      for (double& v : field) v = rng.uniform() < zeros ? 0 : 1 + std::floor(rng.uniform() * 1000);
      Order expected(n);
      for (std::uint32_t i = 0; i < n; ++i) expected[i] = i;
      std::ranges::stable_sort(expected, {}, [&](std::uint32_t i) { return field[i]; });
      EXPECT_EQ(ascending_order(field), expected) << n << " points, zeros: " << zeros;
    }
}

TEST(Distribution, CountsWeightBelowAndAtEachValue) {
  const ScalarField field = {2, 1, 2, 5};
  const Measures measures(4, ScalarField{1, 4, 2, 3});
  const auto [per_vertex, d] = distributions(field, ascending_order(field), measures);
  EXPECT_EQ(per_vertex.mid, (ScalarField{2, 0.5, 2, 3.5}));
  EXPECT_EQ(d.mid, (ScalarField{5.5, 2, 5.5, 8.5}));
  EXPECT_EQ(d.weight_below(2), 4);
  EXPECT_EQ(d.weight_below(2.5), 7);
  EXPECT_EQ(d.weight_below(9), 10);
  EXPECT_EQ(d.quantile(0), 1);
  EXPECT_EQ(d.quantile(0.39), 1);
  EXPECT_EQ(d.quantile(0.41), 2);
  EXPECT_EQ(d.quantile(0.99), 5);
}

TEST(Suite, APerfectMapHasTheBestValues) {
  Rng rng(4, "suite", "");
  GroundTruth truth{ScalarField(200), {{}}};
  for (std::size_t i = 0; i < 200; ++i) truth.saliency[i] = rng.uniform();
  const auto [lowest, highest] = std::ranges::minmax_element(truth.saliency);
  *lowest = 0;
  *highest = 1;
  for (std::size_t i = 0; i < 200; ++i)
    if (truth.saliency[i] > 0.9) truth.picks[0].push_back(static_cast<std::int32_t>(i));
  const Values values = all_values(truth.saliency, truth);
  for (const char* name : {"cc", "lcc", "spearman", "sim", "sim_minmax", "auc_exact", "auc_judd", "auc_top10",
                           "cc_area", "spearman_area", "sim_area", "auc_top10_area"})
    EXPECT_NEAR(values.at(name), 1, 0.01) << name;
  for (const char* name : {"kl", "kl_smoothed", "mse", "mae"}) EXPECT_NEAR(values.at(name), 0, 1e-12) << name;
  for (const Metric& metric : metric_table()) {
    if (metric.picks == PickCount::multiplicity) continue;
    ScalarField worse = truth.saliency;
    for (std::size_t i = 0; i < worse.size(); i += 2) worse[i] = 1 - worse[i];
    const double other = all_values(worse, truth).at(metric.name);
    const double sign = metric.higher_is_better ? 1 : -1;
    EXPECT_GT(sign * values.at(metric.name), sign * other) << metric.name;
  }
}

TEST(Suite, ValuesOfASmallExampleByHand) {
  const ScalarField map = {0, 1, 1, 2};
  const GroundTruth truth{{0, 0, 1, 1}, {{3}, {3, 1}}};
  const Values v = all_values(map, truth);
  EXPECT_NEAR(v.at("sim"), 0.25 + 0.5, 1e-12);
  EXPECT_NEAR(v.at("kl"), 0.5 * std::log(2) + 0, 1e-12);
  EXPECT_NEAR(v.at("mse"), (0 + 0.25 + 0.25 + 0) / 4, 1e-12);
  EXPECT_NEAR(v.at("mae"), (0 + 0.5 + 0.5 + 0) / 4, 1e-12);
  EXPECT_NEAR(v.at("ig"), (std::log2(0.25 / 0.25) + std::log2(0.5 / 0.25)) / 2, 1e-12);
  EXPECT_NEAR(v.at("ig_multiplicity"), (0 + 1 + 1) / 3.0, 1e-12);
  EXPECT_NEAR(v.at("ig_centre"), (std::log2(0.25 / 0.2) + std::log2(0.5 / 0.4)) / 2, 1e-12);
  EXPECT_NEAR(v.at("auc_exact"), (1 + 1 + 1 + 0.5) / 4, 1e-12);
  EXPECT_NEAR(v.at("auc_exact_multiplicity"), (2 + 2 + 1 + 0.5) / 6, 1e-12);
  // (0, 0), (0, 1/2), (1/2, 1), (1, 1)
  EXPECT_NEAR(v.at("auc_judd"), 0.375 + 0.5, 1e-12);
  EXPECT_NEAR(v.at("nss_multiplicity"), 2 / std::sqrt(0.5) / 3, 1e-12);
  EXPECT_NEAR(v.at("nss_top20"), 0.5 / std::sqrt(0.5), 1e-12);  // both points of the largest value
  EXPECT_NEAR(v.at("auc_top20"), (1 + 0.5 + 1 + 1) / 4, 1e-12);
}

TEST(Suite, AConstantMapIsThatOfChanceWhateverItsValue) {
  const GroundTruth truth{{0, 0.5, 1, 0, 0.2}, {{1, 2}, {2}}};
  const Values of_zero = all_values(ScalarField(5, 0.0), truth);
  for (const double value : {0.0, 0.3, 1.0, 7.0, -2.0, 1.7e308, -1.7e308}) {
    const Values v = all_values(ScalarField(5, value), truth);
    EXPECT_EQ(v, of_zero) << value;
    for (const Metric& metric : metric_table()) {
      const std::string name = metric.name.substr(0, metric.name.find('_'));
      if (name == "auc") {
        EXPECT_NEAR(v.at(metric.name), 0.5, 1e-12) << metric.name << " of " << value;
      } else if (name == "nss") {
        EXPECT_EQ(v.at(metric.name), -0.5) << metric.name;
      } else if (name == "cc" || name == "lcc" || name == "spearman" ||
                 (name == "ig" && !metric.reads_positions)) {
        EXPECT_EQ(v.at(metric.name), 0) << metric.name;
      }
      EXPECT_FALSE(std::isnan(v.at(metric.name))) << metric.name;
    }
    EXPECT_NEAR(v.at("sim"), 0.2 + 0.2 + 0.2 / 1.7, 1e-12);                // with the uniform distribution
    EXPECT_NEAR(v.at("mse"), (0.25 + 0 + 0.25 + 0.25 + 0.09) / 5, 1e-12);  // with 0.5 everywhere
    EXPECT_NEAR(v.at("mae_area"), (0.5 + 0 + 0.5 + 0.5 + 0.3) / 5, 1e-12);
  }
}

TEST(Suite, AConstantGroundTruthHasNoErrorsUnlessItIsZero) {
  const ScalarField map = {0, 0.5, 1};
  for (const double value : {1e-9, 0.5, 1.0, -3.0, 1.7e308}) {
    const Values v = all_values(map, {ScalarField(3, value), {{1}}});
    for (const char* name : {"mse", "mae", "mse_area", "mae_area", "nss_top5"})
      EXPECT_TRUE(std::isnan(v.at(name))) << name << " of " << value;
    EXPECT_EQ(v.at("cc"), 0);
    EXPECT_EQ(v.at("spearman"), 0);
    EXPECT_EQ(std::isnan(v.at("sim")), value < 0);
  }
  EXPECT_NEAR(all_values(map, {ScalarField(3, 0), {}}).at("mse"), 1.25 / 3, 1e-12);
}

struct Field {
  ScalarField map, saliency;
  std::vector<std::int32_t> picks;
};

Field random_field() {
  Rng rng(8, "suite", "");
  Field field{ScalarField(300), ScalarField(300), {}};
  for (std::size_t i = 0; i < 300; ++i) {
    field.map[i] = std::round(rng.uniform() * 50) / 50;
    field.saliency[i] = rng.below(3) == 0 ? 0 : rng.uniform();
    if (rng.below(8) == 0) field.picks.push_back(static_cast<std::int32_t>(i));
  }
  return field;
}

void multiply(ScalarField& field, int power) {
  for (double& value : field) value = std::ldexp(value, power);
}

// 1e-12 is added to values for kl_smoothed, which vanishes beside all of these.
TEST(Suite, OfAGroundTruthAnyMultipleCounts) {
  const Field field = random_field();
  for (const double offset : {0.0, -0.5}) {
    const auto of_multiple = [&](int power) {
      GroundTruth truth{field.saliency, {field.picks}};
      for (double& value : truth.saliency) value = std::ldexp(value + offset, power);
      return all_values(field.map, truth);
    };
    const Values expected = of_multiple(300);
    for (const int power : {450, 479, 481, 900, 1023, 1024})
      for (const auto& [name, value] : of_multiple(power)) {
        EXPECT_TRUE(value == expected.at(name) || (std::isnan(value) && std::isnan(expected.at(name))))
            << name << " at 2^" << power;
        EXPECT_TRUE(std::isfinite(value) || offset < 0) << name;
      }
  }
}

TEST(Suite, AConstantMapScoresAlikeOnAllShapesUnlessItVaries) {
  MetricsOptions options;
  options.constant_nss = -0.5;
  const Field field = random_field();
  const Values of_one = all_values(ScalarField(300, 0.5), {field.saliency, {field.picks}});
  const Values of_other = all_values(ScalarField(5, 0.5), {{0, 0.5, 1, 0, 0.2}, {{1, 2}, {2}}});
  for (const Metric& metric : metric_table()) {
    const std::optional<double> value = score_of_constant(metric, options);
    EXPECT_EQ(!value, metric.constant_varies) << metric.name;
    EXPECT_EQ(!value, std::abs(of_one.at(metric.name) - of_other.at(metric.name)) > 1e-9) << metric.name;
    EXPECT_NEAR(value.value_or(of_one.at(metric.name)), of_one.at(metric.name), 1e-12) << metric.name;
  }
}

TEST(InformationGain, OverTheCentreBiasIsTheGainLessThatOfTheBias) {
  const Field field = random_field();
  ScalarField bias;
  for (std::size_t i = 0; i < field.map.size(); ++i) bias.push_back(static_cast<double>(i + 1));
  ScalarField map = field.map;
  for (double& value : map) value += 0.01;  // floors play no part
  const GroundTruth truth{field.saliency, {field.picks}};
  const Values of_map = all_values(map, truth), of_bias = all_values(bias, truth);
  for (const std::string ending : {"", "_multiplicity", "_area", "_multiplicity_area"}) {
    EXPECT_NEAR(of_map.at("ig_centre" + ending), of_map.at("ig" + ending) - of_bias.at("ig" + ending), 1e-9);
    EXPECT_EQ(of_bias.at("ig_centre" + ending), 0);
  }
  const Scores without = score(metric_table(), map, truth, {}, Rng(1, "scores", "x"));
  for (std::size_t m = 0; m < without.values.size(); ++m)
    EXPECT_TRUE(!metric_table()[m].reads_positions || std::isnan(without.values[m])) << "there is no bias";
}

TEST(Suite, OfTheAreasAnyMultipleCounts) {
  const Field field = random_field();
  const GroundTruth truth{field.saliency, {field.picks}};
  Rng rng(9, "suite", "");
  ScalarField areas(field.map.size());
  for (double& area : areas) area = rng.uniform();
  const Values expected = values_of(metric_table(), field.map, truth, areas);
  for (const int power : {-1000, -500, -150, 150, 500, 1000}) {
    ScalarField multiple = areas;
    multiply(multiple, power);
    EXPECT_EQ(values_of(metric_table(), field.map, truth, multiple), expected) << power;
  }
}

TEST(Suite, RefusesWhatIsNotFinite) {
  const double infinity = std::numeric_limits<double>::infinity();
  const auto said = [](const ScalarField& map, const ScalarField& saliency) -> std::string {
    try {
      all_values(map, {saliency, {{0}}});
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_EQ(said({0, std::nan(""), 1}, {0, 1, 2}),
            "the map is nan at point 1 (0-based), expected a finite number");
  EXPECT_EQ(said({0, 1, -infinity}, {}), "the map is -inf at point 2 (0-based), expected a finite number");
  EXPECT_EQ(said({0, 0.5, 1}, {0, infinity, 2}),
            "the ground truth is inf at point 1 (0-based), expected a finite number");
  EXPECT_EQ(said({0, std::nan(""), 1}, {0, std::nan(""), 2}), "nothing") << "nobody saw the point";
}

TEST(Suite, WithoutPicksMetricsOfPicksAreUndefined) {
  const Values v = all_values({1, 2, 3, 0}, {{0, 1, 2, 3}, {{}, {}}});
  for (const Metric& metric : metric_table()) {
    const bool of_saliency = metric.name.find("top") != std::string::npos || metric.name.starts_with("cc") ||
                             metric.name.starts_with("lcc") || metric.name.starts_with("s") ||
                             metric.name.starts_with("kl") || metric.name.starts_with("m");
    EXPECT_EQ(std::isnan(v.at(metric.name)), !of_saliency) << metric.name;
  }
}

TEST(Suite, WithoutSaliencyMetricsOfItAreUndefined) {
  const Values v = all_values({1, 2, 3, 0}, {{}, {{1}}});
  for (const Metric& metric : metric_table()) {
    const std::string name = metric.name.substr(0, metric.name.find("_top"));
    const bool of_picks =
        name == metric.name && (name.starts_with("auc") || name.starts_with("nss") || name.starts_with("ig"));
    EXPECT_EQ(std::isnan(v.at(metric.name)), !of_picks) << metric.name;
  }
}

TEST(Suite, WithEveryPointPickedOnlyUnpickedNegativesAreMissing) {
  const Values v = all_values({1, 2, 3}, {{0, 1, 2}, {{0, 1, 2}}});
  for (const char* name : {"auc_exact", "auc_judd", "auc_exact_multiplicity", "auc_judd_multiplicity"})
    EXPECT_TRUE(std::isnan(v.at(name))) << name;
  for (const char* name : {"auc", "auc_borji", "auc_exact_area", "auc_judd_area", "nss", "ig"})
    EXPECT_FALSE(std::isnan(v.at(name))) << name;
}

TEST(Suite, AGroundTruthOfZerosOrWithNegativeValuesIsNoDistribution) {
  for (const ScalarField& saliency : {ScalarField{0, 0, 0}, ScalarField{-1, 1, 2}}) {
    const Values v = all_values({1, 2, 0}, {saliency, {}});
    for (const char* name : {"kl", "kl_smoothed", "sim", "kl_area", "sim_area"})
      EXPECT_TRUE(std::isnan(v.at(name))) << name;
    EXPECT_FALSE(std::isnan(v.at("mse")));
  }
  EXPECT_TRUE(std::isnan(all_values({-1, 2}, {{0, 1}, {}}).at("kl")));
}

TEST(Suite, NoMetricDependsOnWhichOthersAreComputed) {
  Rng rng(5, "suite", "");
  ScalarField map(300), areas(300);
  GroundTruth truth{ScalarField(300), {{}, {}}};
  for (std::size_t i = 0; i < 300; ++i) {
    map[i] = std::round(rng.uniform() * 50) / 50;
    areas[i] = rng.uniform();
    truth.saliency[i] = std::max(0.0, rng.uniform() - 0.5);
    if (rng.below(8) == 0) truth.picks[i % 2].push_back(static_cast<std::int32_t>(i));
  }
  const Values together = values_of(metric_table(), map, truth, areas);
  std::vector<Metric> reversed(metric_table().rbegin(), metric_table().rend());
  EXPECT_EQ(values_of(reversed, map, truth, areas), together);
  for (const Metric& metric : metric_table())
    EXPECT_EQ(values_of({&metric, 1}, map, truth, areas).at(metric.name), together.at(metric.name))
        << metric.name;
}

TEST(SampledAuc, ApproachesTheProbabilityWithManySplits) {
  Rng rng(6, "suite", "");
  ScalarField map(500);
  for (double& value : map) value = rng.uniform();
  const std::vector<std::int32_t> picked = {3, 40, 44, 100, 171, 300, 420};
  ScalarField positives;
  for (const std::int32_t i : picked) positives.push_back(map[static_cast<std::size_t>(i)]);
  Draws draws(Rng(1, "scores", "x"));
  const Measures measures(map.size(), {});
  const Comparison comparison({.map = map, .measures = measures}, draws);
  const Distribution& all = comparison.map_distribution(Weighting::vertex);
  double probability = 0;
  for (const std::int32_t i : picked) probability += all.mid[static_cast<std::size_t>(i)] / 500 / 7;
  const std::vector<QuantileCurve> curves = {{all, Thresholds::even}, {all, Thresholds::tenths}};
  const std::vector<double> areas = quantile_aucs(curves, positives, draws, {3000, 400});
  EXPECT_NEAR(areas[0], probability, 0.005);
  EXPECT_NEAR(areas[1], probability, 0.03);  // ten steps
}

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

TEST(ChosenMetrics, ComeInTheOrderOfTheTable) {
  MetricsOptions options;
  options.names = {"kl", "nss", "auc_judd_area"};
  std::vector<std::string> names;
  for (const Metric& metric : chosen_metrics(options)) names.push_back(metric.name);
  EXPECT_EQ(names, (std::vector<std::string>{"nss", "kl", "auc_judd_area"}));
  EXPECT_TRUE(any_by_area(chosen_metrics(options)));
  EXPECT_FALSE(any_by_area(chosen_metrics({})));
  options.names = {"nss", "no_such"};
  EXPECT_THROW(chosen_metrics(options), OptionError);
}

TEST(MetricTable, DensitiesReadMapsWithoutMatching) {
  for (const Metric& metric : metric_table()) {
    const std::string name = metric.name.substr(0, metric.name.find('_'));
    EXPECT_EQ(metric.matching == Matching::none, name == "kl" || name == "sim" || name == "ig")
        << metric.name;
  }
}

TEST(ChosenMetrics, HaveTheMatchingAndTheVersionOfTheirReading) {
  const auto version = [](const std::vector<std::string>& names, const ByName<Matching>& matching) {
    MetricsOptions options;
    options.names = names;
    options.matching = matching;
    return scores_version(chosen_metrics(options));
  };
  EXPECT_EQ(scores_version(chosen_metrics({})), 1) << "the paper's";
  EXPECT_EQ(version({"nss", "kl"}, {}), 3);
  EXPECT_EQ(version({"nss", "kl"}, {{"kl", Matching::histogram}}), 1);
  EXPECT_EQ(version({"nss"}, {{"nss", Matching::none}}), 3);
  EXPECT_EQ(version({"mse"}, {{"kl", Matching::none}}), 2);
}

TEST(MetricsByMatching, ScoresEachPartOnceAndKeepsTheOrder) {
  MetricsOptions options;
  options.names = {"nss", "ig", "spearman", "kl", "mse"};
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
  EXPECT_EQ(scores.values, (std::vector<double>{3, 2, 8, 2, 3}));
  EXPECT_EQ(scores.n_points, 7);
  EXPECT_EQ(scores.n_picks, 3);
  EXPECT_FALSE(MetricsByMatching({}).any(Matching::none));
}

TEST(MetricTable, LowerIsBetterForDistancesAlone) {
  std::vector<std::string> lower;
  for (const Metric& metric : metric_table())
    if (!metric.higher_is_better) lower.push_back(metric.name);
  EXPECT_EQ(lower, (std::vector<std::string>{"kl", "kl_smoothed", "mse", "mae", "kl_area", "kl_smoothed_area",
                                             "mse_area", "mae_area"}));
}

}  // namespace
}  // namespace salbench
