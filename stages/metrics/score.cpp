// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/score.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/core/seen.h"
#include "stages/geometry/centre.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/metrics/surface_graph.h"

namespace salbench {
namespace {

// Value of a constant map: halfway between least and most salient, as in its histogram.
constexpr double kMiddle = 0.5;

void check_fits(std::size_t n, const GroundTruth& truth, std::span<const std::int32_t> picked) {
  if (!truth.saliency.empty() && truth.saliency.size() != n)
    throw ShapeError("the ground truth has " + std::to_string(truth.saliency.size()) + " values for " +
                     std::to_string(n) + " points");
  // Ascending: checking the ends suffices.
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

}  // namespace

ScalarField unmatched(std::span<const double> map, Matching reading) {
  if (is_normalised(reading)) return min_max_normalised(map);
  require_finite(map, "the map", true);
  ScalarField values;
  for (const double value : map) values.push_back(std::isnan(value) ? 0 : value);
  const double least = values.empty() ? 0 : *std::ranges::min_element(values);
  if (least >= 0) return values;
  if (reading != Matching::shifted)
    throw ShapeError(
        "the map has a value below 0, " + std::to_string(least) +
        ", and its metrics read it raw: write matching: shifted, which subtracts the least value");
  for (double& value : values) value -= least;
  return values;
}

Measures measures_of(std::span<const Metric> metrics, std::size_t n, Points points, Surface surface,
                     ScalarField negatives) {
  Measures measures{.size = n, .negatives = std::move(negatives)};
  if (any_reads(metrics, Reads::areas)) measures.areas = barycentric_areas(points, surface);
  if (any_reads(metrics, Reads::positions)) measures.centre_bias = distances_from_centroid(points);
  if (any_reads(metrics, Reads::surface_distances))
    measures.surface = std::make_shared<const SurfaceGraph>(surface_graph(points, surface));
  return measures;
}

Scores score(std::span<const Metric> metrics, std::span<const double> map, const GroundTruth& truth,
             const MetricsOptions& options, const Rng& rng, const Measures& measures) {
  check(options);
  const std::vector<std::int32_t> picked = picked_points(truth), every_pick = picks_with_multiplicity(truth);
  check_fits(map.size(), truth, picked);
  CHECK_EQ(measures.size, map.size());
  const bool all_seen = wrong_with_values(truth.saliency).empty();
  if (const auto seen = all_seen ? std::nullopt : seen_points(truth.saliency)) {
    if (seen->empty()) return {std::vector<double>(metrics.size(), kUndefined), 0, 0};
    return score(metrics, values_at(map, *seen), truth_at(truth, *seen), options, rng, measures.at(*seen));
  }
  require_finite(map, "the map");
  if (!all_seen) require_finite(truth.saliency, "the ground truth");
  if (is_constant(map) && !map.empty() && map[0] != kMiddle)
    return score(metrics, ScalarField(map.size(), kMiddle), truth, options, rng, measures);
  const Comparison comparison({map, truth.saliency, measures, options.floor});
  Scores scores;
  for (const Metric& metric : metrics)
    scores.values.push_back(metric.value({map, metric.picks == PickCount::once ? picked : every_pick, options,
                                          rng, metric.matching, comparison}));
  scores.n_points = static_cast<std::int64_t>(map.size());
  scores.n_picks = static_cast<std::int64_t>(picked.size());
  return scores;
}

Scores score(const ScalarField& map, const GroundTruth& truth, const MetricsOptions& options,
             const Rng& rng) {
  return score(chosen_metrics(options), map, truth, options, rng, {.size = map.size()});
}

Scores in_range(std::span<const Metric> metrics, Scores scores) {
  CHECK_EQ(scores.values.size(), metrics.size());
  for (std::size_t m = 0; m < metrics.size(); ++m)  // NaN is kept
    scores.values[m] = std::clamp(scores.values[m], metrics[m].range.low, metrics[m].range.high);
  return scores;
}

std::optional<double> score_of_constant(const Metric& metric, const MetricsOptions& options) {
  if (metric.constant_varies) return {};
  const GroundTruth truth{{0, 0.5, 1}, {{1}}};  // any shape will do: three points
  Measures measures{.size = 3, .areas = ScalarField(3, 1.0), .negatives = ScalarField(3, 1.0)};
  measures.surface = std::make_shared<const SurfaceGraph>(
      surface_graph(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, Faces{{0, 1, 2}}));
  return score({&metric, 1}, ScalarField(3, kMiddle), truth, options, Rng(0, "", ""), measures).values[0];
}

double value_of(const Scores& scores, std::string_view metric, const MetricsOptions& options) {
  const std::vector<Metric> chosen = chosen_metrics(options);
  const auto row = std::ranges::find(chosen, metric, &Metric::name);
  if (row == chosen.end()) throw std::out_of_range("no metric '" + std::string(metric) + "'");
  return scores.values.at(static_cast<std::size_t>(row - chosen.begin()));
}

}  // namespace salbench
