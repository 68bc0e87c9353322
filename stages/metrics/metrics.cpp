// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/metrics.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/core/number.h"
#include "stages/core/seen.h"
#include "stages/geometry/centre.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/metrics/roc.h"
#include "stages/metrics/surface_graph.h"

namespace salbench {
namespace {

// A constant map counts as this one: halfway between the least and the most salient, where its histogram has
// it too.
constexpr double kMiddle = 0.5;

// Versions of `scores` with which metrics could read maps unmatched, and maps not in [0, 1] have no floor.
constexpr std::int32_t kUnmatchedSince = 3, kUnflooredSince = 5;

void check_fits(std::size_t n, const GroundTruth& truth, std::span<const std::int32_t> picked) {
  if (!truth.saliency.empty() && truth.saliency.size() != n)
    throw ShapeError("the ground truth has " + std::to_string(truth.saliency.size()) + " values for " +
                     std::to_string(n) + " points");
  // Ascending: the ends tell.
  if (!picked.empty() && (picked.front() < 0 || static_cast<std::size_t>(picked.back()) >= n))
    throw ShapeError("the ground truth picks point " +
                     std::to_string(picked.front() < 0 ? picked.front() : picked.back()) + " of " +
                     std::to_string(n));
}

std::vector<std::int32_t> picks_with_multiplicity(const GroundTruth& truth) {
  std::vector<std::int32_t> picked;
  for (const auto& participant : truth.picks)
    picked.insert(picked.end(), participant.begin(), participant.end());
  std::ranges::sort(picked);
  return picked;
}

GroundTruth scaled(GroundTruth truth, double scale) {
  for (double& value : truth.saliency) value *= scale;
  return truth;
}

}  // namespace

void check(const MetricsOptions& options) {
  check_ranges(options);
  smoothing_steps(options);
}

std::vector<std::int32_t> smoothing_steps(const MetricsOptions& options) {
  constexpr std::int32_t kMostSteps = 100000;
  std::vector<std::int32_t> steps;
  for (const std::string& word : options.smoothing) {
    steps.push_back(number_in<std::int32_t>(word).value_or(-1));
    if (steps.back() < 0 || steps.back() > kMostSteps)
      throw OptionError("smoothing",
                        "has '" + word + "', not a number of steps from 0 to " + std::to_string(kMostSteps));
    if (steps.size() > 1 && steps.back() <= steps.end()[-2])
      throw OptionError("smoothing", "has " + word + " after " + std::to_string(steps.end()[-2]) +
                                         ": expected ascending numbers of steps");
  }
  return steps;
}

double nss(std::span<const double> map, std::span<const std::int32_t> picked, const Moments& of_map,
           double constant) {
  if (picked.empty()) return kUndefined;
  if (of_map.constant) return constant;
  double sum = 0;
  for (const std::int32_t i : picked) sum += map[static_cast<std::size_t>(i)] - of_map.mean;
  return sum / (static_cast<double>(picked.size()) * of_map.deviation);
}

double nss(std::span<const double> map, std::span<const std::int32_t> picked, double constant) {
  return nss(map, picked, moments(map, vertex_measure(map.size())), constant);
}

double cc(std::span<const double> map, std::span<const double> saliency) {
  return correlation(pair_moments(map, saliency, vertex_measure(map.size())));
}

std::vector<Metric> chosen_metrics(const MetricsOptions& options) {
  const std::span<const Metric> table = metric_table();
  for (const std::string& name : options.names)
    if (std::ranges::find(table, name, &Metric::name) == table.end())
      throw OptionError("names", "has no metric '" + name + "'");
  std::vector<Metric> chosen;
  for (const Metric& metric : table) {
    if (std::ranges::find(options.names, metric.name) == options.names.end()) continue;
    chosen.push_back(metric);
    Metric& added = chosen.back();
    if (const auto matching = options.matching.find(metric.name); matching != options.matching.end())
      added.matching = matching->second;
    added.constant_varies |= added.matching == Matching::fitted;  // by the centre bias
    if (options.floor != 0 && !is_normalised(added.matching))
      added.since = std::max(added.since, kUnflooredSince);
  }
  return chosen;
}

ScalarField unmatched(std::span<const double> map, Matching reading) {
  if (is_normalised(reading)) return min_max_normalised(map);
  require_finite(map, "the map", true);
  const double scale = scale_to_ordinary(map);
  ScalarField values;
  for (const double value : map) values.push_back(std::isnan(value) ? 0 : value * scale);
  const double least = values.empty() ? 0 : *std::ranges::min_element(values);
  if (least >= 0) return values;
  if (reading != Matching::shifted)
    throw ShapeError(
        "the map has a value below 0, " + std::to_string(least / scale) +
        ", and its metrics read it raw: write matching: shifted, which subtracts the least value");
  for (double& value : values) value -= least;
  return values;
}

std::int32_t scores_version(std::span<const Metric> metrics) {
  std::int32_t version = 1;
  for (const Metric& metric : metrics)
    version = std::max({version, metric.since, metric.matching == Matching::histogram ? 1 : kUnmatchedSince});
  return version;
}

bool any_by_area(std::span<const Metric> metrics) {
  return std::ranges::any_of(metrics,
                             [](const Metric& metric) { return metric.weighting == Weighting::area; });
}

bool any_of_positions(std::span<const Metric> metrics) {
  return std::ranges::any_of(metrics, &Metric::reads_positions);
}

bool any_of_others(std::span<const Metric> metrics) {
  return std::ranges::any_of(metrics, &Metric::reads_others);
}

bool any_of_points(std::span<const Metric> metrics) {
  return any_of_positions(metrics) || any_of_others(metrics) || any_of_faces(metrics);
}

bool any_of_faces(std::span<const Metric> metrics) {
  return any_by_area(metrics) || std::ranges::any_of(metrics, &Metric::reads_surface);
}

Measures measures_of(std::span<const Metric> metrics, std::size_t n, Points points, Surface surface,
                     ScalarField negatives) {
  Measures measures(n, any_by_area(metrics) ? barycentric_areas(points, surface) : ScalarField{},
                    any_of_positions(metrics) ? distances_from_centroid(points) : ScalarField{});
  if (std::ranges::any_of(metrics, &Metric::reads_surface))
    measures.surface = std::make_shared<const SurfaceGraph>(surface_graph(points, surface));
  measures.negatives = std::move(negatives);
  return measures;
}

Scores score(std::span<const Metric> metrics, std::span<const double> map, const GroundTruth& truth,
             const MetricsOptions& options, const Rng& rng, const Measures& measures) {
  check(options);
  const std::vector<std::int32_t> picked = picked_points(truth), every_pick = picks_with_multiplicity(truth);
  check_fits(map.size(), truth, picked);
  CHECK_EQ(measures.size(), map.size());
  if (const auto seen = seen_points(truth.saliency)) {
    if (seen->empty()) return {std::vector<double>(metrics.size(), kUndefined), 0, 0};
    return score(metrics, values_at(map, *seen), truth_at(truth, *seen), options, rng, measures.at(*seen));
  }
  require_finite(map, "the map");
  require_finite(truth.saliency, "the ground truth");
  if (is_constant(map) && !map.empty() && map[0] != kMiddle)
    return score(metrics, ScalarField(map.size(), kMiddle), truth, options, rng, measures);
  if (const double scale = scale_to_ordinary(truth.saliency); scale != 1)
    return score(metrics, map, scaled(truth, scale), options, rng, measures);
  const ScalarField saliency = truth.saliency.empty() ? ScalarField{} : min_max_normalised(truth.saliency);
  const Comparison comparison({map, saliency, truth.saliency, measures, options.floor});
  Scores scores;
  for (const Metric& metric : metrics) {
    const bool without_areas = metric.weighting == Weighting::area && measures.area.empty();
    scores.values.push_back(
        without_areas ? kUndefined
                      : metric.value({map, metric.picks == PickCount::once ? picked : every_pick, saliency,
                                      options, rng, metric.weighting, metric.matching, comparison}));
  }
  scores.n_points = static_cast<std::int64_t>(map.size());
  scores.n_picks = static_cast<std::int64_t>(picked.size());
  return scores;
}

Scores score(std::span<const Metric> metrics, const ScalarField& map, const GroundTruth& truth,
             const MetricsOptions& options, const Rng& rng, std::span<const double> areas,
             std::span<const double> centre_bias) {
  return score(metrics, map, truth, options, rng, Measures(map.size(), areas, centre_bias));
}

Scores score(const ScalarField& map, const GroundTruth& truth, const MetricsOptions& options, Rng rng,
             std::span<const double> areas) {
  return score(chosen_metrics(options), map, truth, options, rng, areas);
}

Scores in_range(std::span<const Metric> metrics, Scores scores) {
  CHECK_EQ(scores.values.size(), metrics.size());
  for (std::size_t m = 0; m < metrics.size(); ++m)  // NaN stays
    scores.values[m] = std::clamp(scores.values[m], metrics[m].range.low, metrics[m].range.high);
  return scores;
}

std::optional<double> score_of_constant(const Metric& metric, const MetricsOptions& options) {
  if (metric.constant_varies) return {};
  const GroundTruth truth{{0, 0.5, 1}, {{1}}};  // of any shape: three points
  Measures measures(3, ScalarField(3, 1.0));
  measures.negatives = ScalarField(3, 1.0);
  measures.surface = std::make_shared<const SurfaceGraph>(
      surface_graph(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, Faces{{0, 1, 2}}));
  return score({&metric, 1}, ScalarField(3, kMiddle), truth, options, Rng(0, "", ""), measures).values[0];
}

MetricsByMatching::MetricsByMatching(const MetricsOptions& options) : all_(chosen_metrics(options)) {
  for (std::size_t m = 0; m < all_.size(); ++m) {
    Part& part = parts_[static_cast<std::size_t>(all_[m].matching)];
    part.metrics.push_back(all_[m]);
    part.places.push_back(m);
  }
}

Scores MetricsByMatching::score(const ScorePart& score_part) const {
  Scores scores{std::vector<double>(all_.size(), kUndefined)};
  for (const Matching matching :
       {Matching::histogram, Matching::none, Matching::raw, Matching::shifted, Matching::fitted}) {
    if (!any(matching)) continue;
    const Scores of_part = score_part(part(matching).metrics, matching);
    if (of_part.values.empty()) continue;
    for (std::size_t m = 0; m < of_part.values.size(); ++m)
      scores.values[part(matching).places[m]] = of_part.values[m];
    scores.n_points = of_part.n_points;
    scores.n_picks = of_part.n_picks;
  }
  return scores;
}

double value_of(const Scores& scores, std::string_view metric, const MetricsOptions& options) {
  const std::vector<Metric> chosen = chosen_metrics(options);
  const auto row = std::ranges::find(chosen, metric, &Metric::name);
  if (row == chosen.end()) throw std::out_of_range("no metric '" + std::string(metric) + "'");
  return scores.values.at(static_cast<std::size_t>(row - chosen.begin()));
}

}  // namespace salbench
