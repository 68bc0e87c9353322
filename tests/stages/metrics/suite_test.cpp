// SPDX-License-Identifier: GPL-3.0-or-later
// Metrics beyond the paper's: known answers, degenerate input, and independence of the other metrics. Random
// cases against other implementations are in metrics_reference.py.

#include "stages/matching/matching.h"
#include "tests/stages/metrics/complete.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

using Values = std::map<std::string, double>;

Values values_of(std::span<const Metric> metrics, const ScalarField& map, const GroundTruth& truth,
                 const ScalarField& areas) {
  ScalarField centre_bias(map.size());
  std::iota(centre_bias.begin(), centre_bias.end(), 1.0);
  const Scores scores = score(metrics, map, truth, {.constant_nss = -0.5}, Rng(1, "scores", "x"),
                              complete_measures(map.size(), areas, centre_bias));
  Values values;
  for (std::size_t m = 0; m < metrics.size(); ++m) values[metrics[m].name] = scores.values[m];
  return values;
}

Values all_values(const ScalarField& map, const GroundTruth& truth) {
  return values_of(metric_table(), map, truth, ScalarField(map.size(), 0.5));
}

TEST(Suite, APerfectMapHasTheBestValues) {
  Rng rng(4, "suite", "");
  GroundTruth truth{ScalarField(200), {{}}};
  for (std::size_t i = 0; i < 200; ++i) truth.saliency[i] = rng.uniform();
  truth.saliency[7] = 0, truth.saliency[9] = 1;
  for (std::size_t i = 0; i < 200; ++i)
    if (truth.saliency[i] > 0.9) truth.picks[0].push_back(static_cast<std::int32_t>(i));
  const Values values = all_values(truth.saliency, truth);
  for (const char* name :
       {"cc", "lcc", "spearman", "sim", "sim_minmax", "auc_exact", "auc_judd", "auc_top20", "cc_area"})
    EXPECT_NEAR(values.at(name), 1, 0.01) << name;
  for (const char* name : {"kl", "kl_smoothed"}) EXPECT_NEAR(values.at(name), 0, 1e-12) << name;
  for (const Metric& metric : metric_table()) {
    if (metric.picks == PickCount::multiplicity) continue;
    ScalarField worse = truth.saliency;
    for (std::size_t i = 0; i < worse.size(); i += 2) worse[i] = 1 - worse[i];
    const double other = all_values(worse, truth).at(metric.name);
    const double sign = metric.higher_is_better ? 1 : -1;
    EXPECT_GT(sign * values.at(metric.name), sign * other) << metric.name;
  }
}

TEST(Suite, AConstantMapIsThatOfChanceWhateverItsValue) {
  const GroundTruth truth{{0, 0.5, 1, 0, 0.2}, {{1, 2}, {2}}};
  const Values of_zero = all_values(ScalarField(5, 0.0), truth);
  for (const double value : {0.0, 0.3, 1.0, 7.0, -2.0, 1.7e99, -1.7e99}) {
    const Values v = all_values(ScalarField(5, value), truth);
    EXPECT_EQ(v, of_zero) << value;
    for (const Metric& metric : metric_table()) {
      const std::string name = metric.name.substr(0, metric.name.find('_'));
      if (name == "auc") {
        EXPECT_NEAR(v.at(metric.name), 0.5, 1e-12) << metric.name << " of " << value;
      } else if (name == "nss") {
        EXPECT_EQ(v.at(metric.name), -0.5) << metric.name;
      } else if (name == "cc" || name == "lcc" || name == "spearman" ||
                 (name == "ig" && metric.reads != Reads::positions)) {
        EXPECT_EQ(v.at(metric.name), 0) << metric.name;
      }
      EXPECT_FALSE(std::isnan(v.at(metric.name))) << metric.name;
    }
    EXPECT_NEAR(v.at("sim"), 0.2 + 0.2 + 0.2 / 1.7, 1e-12);  // against the uniform distribution
  }
}

TEST(Suite, AConstantGroundTruthHasNoTop) {
  const ScalarField map = {0, 0.5, 1};
  for (const double value : {1e-9, 0.5, 1.0, -3.0, 1.7e99}) {
    const Values v = all_values(map, {ScalarField(3, value), {{1}}});
    EXPECT_TRUE(std::isnan(v.at("auc_top20"))) << value;
    EXPECT_EQ(v.at("cc"), 0);
    EXPECT_EQ(v.at("spearman"), 0);
    EXPECT_EQ(std::isnan(v.at("sim")), value < 0);
  }
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

// These metrics add a constant to values, in the values' own unit.
bool adds_to_values(const std::string& name) {
  return name.starts_with("kl_smoothed") || name.starts_with("kl_pysaliency");
}

bool of_unit(Matching reading) { return reading == Matching::raw || reading == Matching::shifted; }

TEST(Suite, OfAMapAnyMultipleCountsHoweverItIsRead) {
  Field field = random_field();
  for (double& value : field.map) value = std::round(value * 64) / 64;
  const GroundTruth truth{field.saliency, {field.picks}};
  const ScalarField areas(field.map.size(), 0.5);
  Histogram reference{};
  for (std::size_t k = 0; k < kHistogramBins; ++k)
    reference[k] = static_cast<double>(kHistogramBins - k) / 50.5;
  for (const Matching reading : {Matching::none, Matching::histogram, Matching::raw, Matching::shifted}) {
    const auto of_multiple = [&](int power, double offset) {
      ScalarField map = field.map;
      for (double& value : map) value = std::ldexp(value + offset, power);
      return values_of(metric_table(),
                       reading == Matching::histogram ? matched(map, reference) : unmatched(map, reading),
                       truth, areas);
    };
    const std::vector<double> offsets =
        reading == Matching::raw ? std::vector<double>{0, 0.25} : std::vector<double>{0, 0.25, -0.5};
    for (const double offset : offsets) {
      const Values expected = of_multiple(0, offset);
      for (const int power : {-320, -257, -60, 1, 300})
        for (const auto& [name, value] : of_multiple(power, offset)) {
          EXPECT_TRUE(std::isfinite(value)) << name << " at 2^" << power;
          if (of_unit(reading) && adds_to_values(name)) continue;
          EXPECT_EQ(value, expected.at(name))
              << name << " at 2^" << power << ", read as " << name_of(reading);
        }
    }
  }
}

TEST(Suite, OfAGroundTruthOrNegativesAnySmallMultipleCounts) {
  const Field field = random_field();
  ScalarField few_digits = field.saliency;
  for (double& value : few_digits) value = std::round(value * 64) / 64;
  const auto of_multiples = [&](int of_truth, int of_negatives, int of_areas) {
    GroundTruth truth{few_digits, {field.picks}};
    multiply(truth.saliency, of_truth);
    ScalarField areas(few_digits.size(), 0.5);
    multiply(areas, of_areas);
    Measures measures = complete_measures(few_digits.size(), areas, few_digits);
    multiply(measures.negatives, of_negatives);
    const Rng draws(1, "scores", "x");
    return score(metric_table(), field.map, truth, {}, draws, measures).values;
  };
  const std::vector<double> expected = of_multiples(0, 0, 0);
  for (const int power : {-320, -257, 300})
    for (const auto& [of_truth, of_negatives, of_areas] :
         {std::array{power, 0, 0}, {0, power, 0}, {power, 0, -1000}, {power, 0, 150}, {0, power, -150}}) {
      const std::vector<double> values = of_multiples(of_truth, of_negatives, of_areas);
      for (std::size_t m = 0; m < values.size(); ++m) {
        const std::string& name = metric_table()[m].name;
        EXPECT_TRUE(std::isfinite(values[m])) << name << " at 2^" << power;
        if (of_truth != 0 && adds_to_values(name)) continue;
        EXPECT_EQ(values[m], expected[m]) << name << " at 2^" << power;
      }
    }
}

// kl_smoothed adds 1e-12 to values, which is negligible relative to all of these.
TEST(Suite, OfAGroundTruthAnyMultipleCounts) {
  const Field field = random_field();
  for (const double offset : {0.0, -0.5}) {
    const auto of_multiple = [&](int power) {
      GroundTruth truth{field.saliency, {field.picks}};
      for (double& value : truth.saliency) value = std::ldexp(value + offset, power);
      return all_values(field.map, truth);
    };
    const Values expected = of_multiple(300);
    for (const int power : {310, 330})
      for (const auto& [name, value] : of_multiple(power)) {
        EXPECT_TRUE(value == expected.at(name) || (std::isnan(value) && std::isnan(expected.at(name))))
            << name << " at 2^" << power;
        EXPECT_TRUE(std::isfinite(value) || offset < 0) << name;
      }
  }
}

TEST(Suite, AConstantMapScoresAlikeOnAllShapesUnlessItVaries) {
  const Field field = random_field();
  const Values of_one = all_values(ScalarField(300, 0.5), {field.saliency, {field.picks}});
  const Values of_other = all_values(ScalarField(5, 0.5), {{0, 0.5, 1, 0, 0.2}, {{1, 2}, {2}}});
  for (const Metric& metric : metric_table()) {
    const std::optional<double> value = score_of_constant(metric, {.constant_nss = -0.5});
    EXPECT_EQ(!value, metric.constant_varies) << metric.name;
    EXPECT_EQ(!value, std::abs(of_one.at(metric.name) - of_other.at(metric.name)) > 1e-9) << metric.name;
    EXPECT_NEAR(value.value_or(of_one.at(metric.name)), of_one.at(metric.name), 1e-12) << metric.name;
  }
}

TEST(Suite, RefusesWhatIsNotFinite) {
  const auto scoring = [](const ScalarField& map, const ScalarField& saliency) {
    return [=] { all_values(map, {saliency, {{0}}}); };
  };
  EXPECT_THAT(scoring({0, kNan, 1}, {0, 1, 2}), Refuses("the map: value 1 "));
  EXPECT_THAT(scoring({0, 1, -kInfinity}, {}), Refuses("the map: value 2 "));
  EXPECT_THAT(scoring({0, 0.5, 1}, {0, kInfinity, 2}), Refuses("the ground truth: value 1 "));
  EXPECT_NO_THROW(scoring({0, kNan, 1}, {0, kNan, 2})()) << "nobody saw the point";
}

TEST(Suite, WithoutSaliencyMetricsOfItAreUndefined) {
  const Values v = all_values({1, 2, 3, 0}, {{}, {{1}}});
  for (const Metric& metric : metric_table()) {
    const std::string name = metric.name.substr(0, metric.name.find("_top"));
    const bool of_picks = name == metric.name &&
                          (name.starts_with("auc") || name.starts_with("nss") || name.starts_with("ig") ||
                           metric.reads == Reads::other_shapes || metric.reads == Reads::surface_distances);
    EXPECT_EQ(std::isnan(v.at(metric.name)), !of_picks) << metric.name;
  }
}

TEST(Suite, AGroundTruthOfZerosOrWithNegativeValuesIsNoDistribution) {
  for (const ScalarField& saliency : {ScalarField{0, 0, 0}, ScalarField{-1, 1, 2}}) {
    const Values v = all_values({1, 2, 0}, {saliency, {}});
    for (const char* name : {"kl", "kl_smoothed", "kl_pysaliency", "kl_shifted", "sim"})
      EXPECT_TRUE(std::isnan(v.at(name))) << name;
    EXPECT_EQ(std::isnan(v.at("sim_minmax")), saliency[0] == 0) << "after min-max none is below 0";
  }
  EXPECT_TRUE(std::isnan(all_values({-1, 2}, {{0, 1}, {}}).at("kl")));
}

TEST(Suite, NoMetricDependsOnWhichOthersAreComputed) {
  const Field field = random_field();
  const GroundTruth truth{field.saliency, {field.picks, {1, 2}}};
  const ScalarField areas = field.saliency;
  const Values together = values_of(metric_table(), field.map, truth, areas);
  std::vector<Metric> reversed(metric_table().rbegin(), metric_table().rend());
  EXPECT_EQ(values_of(reversed, field.map, truth, areas), together);
  for (const Metric& metric : metric_table())
    EXPECT_EQ(values_of({&metric, 1}, field.map, truth, areas).at(metric.name), together.at(metric.name))
        << metric.name;
}

}  // namespace
}  // namespace salbench
