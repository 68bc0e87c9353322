#include "stages/metrics/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"

namespace salbench {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

double at(std::span<const double> field, std::int32_t i) { return field[static_cast<std::size_t>(i)]; }

double mean(std::span<const double> field) {
  return std::accumulate(field.begin(), field.end(), 0.0) / static_cast<double>(field.size());
}

std::vector<double> sorted_values(std::span<const double> map, std::span<const std::int32_t> points) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const std::int32_t i : points) values.push_back(at(map, i));
  std::sort(values.begin(), values.end());
  return values;
}

// Fraction of the ascending values that are >= threshold.
double rate(const std::vector<double>& values, double threshold) {
  const auto reached = values.end() - std::lower_bound(values.begin(), values.end(), threshold);
  return static_cast<double>(reached) / static_cast<double>(values.size());
}

// The curve runs from (1, 1) over the thresholds to (0, 0).
double area_under_curve(const std::vector<double>& positives, const std::vector<double>& negatives,
                        std::int32_t thresholds) {
  const double largest = std::max(positives.back(), negatives.back());
  double area = 0;
  double true_rate = 1, false_rate = 1;
  const auto advance = [&](double next_true_rate, double next_false_rate) {
    area += (false_rate - next_false_rate) * (true_rate + next_true_rate) / 2;
    true_rate = next_true_rate;
    false_rate = next_false_rate;
  };
  for (std::int32_t t = 0; t < thresholds; ++t) {
    // The last threshold is the largest value itself: rounding must not lift it above.
    const double threshold = t + 1 == thresholds ? largest : largest * t / (thresholds - 1);
    advance(rate(positives, threshold), rate(negatives, threshold));
  }
  advance(0, 0);
  return area;
}

void check_fits(std::size_t n, const GroundTruth& truth, std::span<const std::int32_t> picked) {
  if (!truth.saliency.empty() && truth.saliency.size() != n)
    throw InputError("the ground truth has " + std::to_string(truth.saliency.size()) + " values for " +
                     std::to_string(n) + " points");
  // Ascending: the ends tell.
  if (!picked.empty() && (picked.front() < 0 || static_cast<std::size_t>(picked.back()) >= n))
    throw InputError("the ground truth picks point " +
                     std::to_string(picked.front() < 0 ? picked.front() : picked.back()) + " of " +
                     std::to_string(n));
}

double correlation(const MetricInput& in) {
  return in.saliency.empty() ? kUndefined : cc(in.map, in.saliency);
}

constexpr std::array kMetricTable = {
    Metric{"auc", "1", "area under the ROC curve by the paper's protocol: sampled negatives, 20 thresholds",
           [](const MetricInput& in) { return auc(in.map, in.picked, in.options, in.rng); }},
    Metric{"auc_exact", "1", "probability that a picked point lies above an unpicked one, ties one half",
           [](const MetricInput& in) { return auc_exact(in.map, in.picked); }},
    Metric{"nss", "standard deviations", "mean height of the picks above the mean of the map",
           [](const MetricInput& in) { return nss(in.map, in.picked, in.options.constant_nss); }},
    Metric{"cc", "1", "Pearson correlation with the saliency of the ground truth", correlation},
    Metric{"lcc", "1", "magnitude of cc", [](const MetricInput& in) { return std::abs(correlation(in)); }},
};

}  // namespace

double auc(std::span<const double> map, std::span<const std::int32_t> picked, const MetricsOptions& options,
           Rng rng) {
  if (picked.empty() || map.size() < 2) return kUndefined;
  const std::vector<double> positives = sorted_values(map, picked);
  std::vector<double> negatives(picked.size());
  double sum = 0;
  for (std::int32_t split = 0; split < options.splits; ++split) {
    for (double& value : negatives) value = map[1 + rng.below(map.size() - 1)];
    std::sort(negatives.begin(), negatives.end());
    sum += area_under_curve(positives, negatives, options.thresholds);
  }
  return sum / options.splits;
}

double auc_exact(std::span<const double> map, std::span<const std::int32_t> picked) {
  const std::size_t unpicked = map.size() - picked.size();
  if (picked.empty() || unpicked == 0) return kUndefined;
  std::vector<double> all(map.begin(), map.end());
  std::sort(all.begin(), all.end());
  const std::vector<double> positives = sorted_values(map, picked);
  // Over all points, of which p * p / 2 fall to picks: each pair of them gives one, each with itself a tie.
  double wins = 0;
  for (const double value : positives) {
    const auto [first, last] = std::equal_range(all.begin(), all.end(), value);
    wins += static_cast<double>(first - all.begin()) + static_cast<double>(last - first) / 2;
  }
  const auto p = static_cast<double>(picked.size());
  return (wins - p * p / 2) / (p * static_cast<double>(unpicked));
}

double nss(std::span<const double> map, std::span<const std::int32_t> picked, double constant) {
  if (picked.empty()) return kUndefined;
  if (is_constant(map)) return constant;
  const double centre = mean(map);
  double squares = 0;
  for (const double value : map) squares += (value - centre) * (value - centre);
  const double deviation = std::sqrt(squares / static_cast<double>(map.size()));
  double sum = 0;
  for (const std::int32_t i : picked) sum += at(map, i) - centre;
  return sum / (static_cast<double>(picked.size()) * deviation);
}

double cc(std::span<const double> map, std::span<const double> saliency) {
  CHECK_EQ(map.size(), saliency.size());
  if (map.empty()) return kUndefined;
  if (is_constant(map) || is_constant(saliency)) return 0;
  const double map_mean = mean(map), saliency_mean = mean(saliency);
  double products = 0, map_squares = 0, saliency_squares = 0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double a = map[i] - map_mean, b = saliency[i] - saliency_mean;
    products += a * b;
    map_squares += a * a;
    saliency_squares += b * b;
  }
  return products / (std::sqrt(map_squares) * std::sqrt(saliency_squares));
}

std::span<const Metric> metric_table() { return kMetricTable; }

std::int32_t scores_version() { return std::ranges::max_element(kMetricTable, {}, &Metric::since)->since; }

Scores score(std::span<const Metric> metrics, const ScalarField& matched, const GroundTruth& truth,
             const MetricsOptions& options, Rng rng) {
  check(options);
  const std::vector<std::int32_t> picked = picked_points(truth);
  check_fits(matched.size(), truth, picked);
  const ScalarField saliency = truth.saliency.empty() ? ScalarField{} : min_max_normalised(truth.saliency);
  const MetricInput input{matched, picked, saliency, options, rng};
  Scores scores;
  for (const Metric& metric : metrics) scores.values.push_back(metric.value(input));
  scores.n_points = static_cast<std::int64_t>(matched.size());
  scores.n_picks = static_cast<std::int64_t>(picked.size());
  return scores;
}

Scores score(const ScalarField& matched, const GroundTruth& truth, const MetricsOptions& options, Rng rng) {
  return score(metric_table(), matched, truth, options, rng);
}

double value_of(const Scores& scores, std::string_view metric) {
  const auto* const row = std::ranges::find(kMetricTable, metric, &Metric::name);
  if (row == kMetricTable.end()) throw std::out_of_range("no metric '" + std::string(metric) + "'");
  return scores.values.at(static_cast<std::size_t>(row - kMetricTable.begin()));
}

}  // namespace salbench
