// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/scoring.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "stages/core/field.h"
#include "stages/core/seen.h"
#include "stages/geometry/centre.h"
#include "stages/geometry/faces.h"
#include "stages/geometry/laplacian.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/matching/matching.h"
#include "stages/metrics/by_matching.h"
#include "stages/metrics/score.h"

namespace salbench {
namespace {

// Saliency of seen points.
ScalarField seen_values(const GroundTruth& truth) {
  const auto seen = seen_points(truth.saliency);
  return seen ? values_at(truth.saliency, *seen) : truth.saliency;
}
const ScalarField& seen_values(const ScalarField& map) { return map; }

// Serial, in item order: sums of doubles depend on the order.
template <class T>
Histogram mean_over(const Members<T>& members) {
  std::vector<Histogram> histograms;
  members.for_each([&](const T& member) {
    const auto& values = seen_values(member);
    // A scan may see no known value. An infinite value fails the stages of its own item, not this one.
    if (!values.empty() && std::ranges::none_of(values, [](double value) { return std::isinf(value); }))
      histograms.push_back(normalised_histogram(values));
  });
  return mean_histogram(histograms);
}

CentreDensity sum_of_densities(const Members<CentreDensity>& members) {
  CentreDensity sum;
  members.for_each([&](const CentreDensity& density) { add(sum, density); });
  return sum;
}

ScoreTable score_table(const Members<Scores>& members) {
  ScoreTable table;
  members.for_each([&](const Scores& scores) { table.rows.push_back(scores); });
  return table;
}

ScoreTable one_after_the_other(const Members<ScoreTable>& members) {
  ScoreTable table;
  members.for_each([&](const ScoreTable& member) {
    table.rows.insert(table.rows.end(), member.rows.begin(), member.rows.end());
  });
  return table;
}

// Ground truth of a shape, and the parts of the shape that metrics read.
struct ScoredShape {
  using Parameters = std::tuple<GroundTruth, Points, Surface>;
  const GroundTruth& truth;
  Points points;
  Surface surface;
};
// Ground truth by distance from the centroid; null if no metric needs it.
struct Densities {
  using Parameters = std::tuple<const CentreDensity*, const CentreDensity*>;
  const CentreDensity *own, *of_set;
};

// Measures for scoring `n` points of a shape, or the faces of a mesh if `faces`.
Measures measures_on(bool faces, std::span<const Metric> metrics, std::size_t n, const ScoredShape& shape,
                     const Densities& densities = {}) {
  const auto& [truth, points, surface] = shape;
  const auto& [own, of_set] = densities;
  if (!faces) return measures_of(metrics, n, points, surface, density_if_known(points, own, of_set));
  const std::vector<Vec3> centroids = face_centroids(points, surface);
  Measures measures{.size = n, .negatives = density_if_known(centroids, own, of_set)};
  if (any_reads(metrics, Reads::areas)) measures.areas = face_areas(points, surface);
  if (any_reads(metrics, Reads::positions)) measures.centre_bias = distances_from_centroid(centroids);
  return measures;
}

// Metrics by which a rule scores maps, on points or on faces.
struct Scorer {
  MetricsByMatching metrics;
  bool on_faces;

  // read_map: returns the map, matched as given.
  template <class ReadMap>
  Scores scores(const ReadMap& read_map, const GroundTruth& truth, const MetricsOptions& options,
                const RandomSource& random, const Measures& measures) const {
    const Rng draws = draws_of_scores(random);
    return metrics.score([&](std::span<const Metric> of_part, Matching matching) -> Scores {
      return score(of_part, read_map(matching), truth, options, draws, measures);
    });
  }
};

// The map on the scored elements.
Output<ScalarField> add_face_map(RuleTable& table, const ShapeOutputs& shape, const Model& model,
                                 const Output<ScalarField>& map) {
  if (!shape.on_faces) return map;
  return table.add(
      shape.level, stage_of(model.name, Role::face_map, 1),
      [](FieldView values, Points points, Surface surface) {
        return values_by_face(values, points.size(), surface);
      },
      map, shape.points, shape.surface);
}

// Reads the map with each kind of matching in use, and the surface if a metric weighs by area; it is not in
// the key of other scores.
Output<Scores> add_scores(RuleTable& table, const ShapeOutputs& shape, const Config& config,
                          const Model& model, const Output<FieldView>& map,
                          const Output<FieldView>& matched_map) {
  const Scorer scorer{MetricsByMatching(config.metrics), shape.on_faces};
  const std::vector<Metric>& metrics = scorer.metrics.all();
  const bool positions = any_of_points(metrics);
  return table.add(
      shape.level, stage_of(model.name, Role::scores, scores_version(metrics)),
      [scorer](FieldView matched_values, FieldView values, const ScoredShape& scored,
               const Densities& densities, const MetricsOptions& options, const RandomSource& random) {
        const std::size_t n = std::max(matched_values.size(), values.size());
        const auto read_map = [&](Matching matching) {
          return matching == Matching::histogram ? ScalarField(matched_values.begin(), matched_values.end())
                                                 : unmatched(values, matching);
        };
        return scorer.scores(read_map, scored.truth, options, random,
                             measures_on(scorer.on_faces, scorer.metrics.all(), n, scored, densities));
      },
      only_if(scorer.metrics.any(Matching::histogram), matched_map),
      only_if(scorer.metrics.any_unmatched(), map),
      together<ScoredShape>(shape.ground_truth, only_if(positions, shape.points),
                            only_if(shape.on_faces ? positions : any_of_faces(metrics), shape.surface)),
      together<Densities>(shape.centre_density, shape.centre_densities), section("metrics", config.metrics),
      kRandom);
}

// Scores of a map after each number of smoothing steps, with the same draws as the plain scores. No other
// rule reads them.
void add_smoothed_scores(RuleTable& table, const ShapeOutputs& shape, const MetricsOptions& chosen,
                         const Model& model, const Output<FieldView>& map) {
  const Scorer scorer{MetricsByMatching(chosen), shape.on_faces};
  const bool match = scorer.metrics.any(Matching::histogram) && !(model.given && model.given->matched);
  const auto tables = table.add(
      shape.level, stage_of(model.name, Role::smoothed_scores, scores_version(scorer.metrics.all())),
      [scorer](FieldView plain, const ScoredShape& scored, const Histogram* reference,
               const Densities& densities, const MetricsOptions& options, const RandomSource& random) {
        const auto& [truth, points, surface] = scored;
        const Measures measures =
            measures_on(scorer.on_faces, scorer.metrics.all(), plain.size(), scored, densities);
        const Adjacency adjacency =
            scorer.on_faces ? face_adjacency(points.size(), surface) : edge_adjacency(points.size(), surface);
        ScalarField values(plain.begin(), plain.end());
        for (double& value : values)
          if (std::isnan(value)) value = 0;  // as in matching and normalisation
        const auto read_map = [&](Matching matching) {
          return matching == Matching::histogram && reference != nullptr ? matched(values, *reference)
                                                                         : unmatched(values, matching);
        };
        ScoreTable by_steps;
        std::int32_t done = 0;
        for (const std::int32_t steps : smoothing_steps(options)) {
          values = smoothed_by_steps(std::move(values), adjacency, steps - std::exchange(done, steps));
          by_steps.rows.push_back(scorer.scores(read_map, truth, options, random, measures));
        }
        return by_steps;
      },
      map, together<ScoredShape>(shape.ground_truth, shape.points, shape.surface),
      only_if(match, shape.reference), together<Densities>(shape.centre_density, shape.centre_densities),
      section("metrics", chosen), kRandom);
  table.add(shape.level, stage_of(model.name, Role::smoothed_table, 1), one_after_the_other, tables);
}

}  // namespace

Rng draws_of_scores(const RandomSource& random) { return random.rng("scores"); }

Output<Histogram> add_reference(RuleTable& table, Level level, const Output<GroundTruth>& truth,
                                const std::optional<Histogram>& given) {
  const auto reference = table.add(level, stage(Role::reference, 1), mean_over<GroundTruth>, truth);
  if (given) table.give(reference, *given);
  return reference;
}

void add_centre_densities(RuleTable& table, ShapeOutputs& shape, const Config& config) {
  if (!any_reads(chosen_metrics(config.metrics), Reads::other_shapes)) return;
  const RuleHead head = stage(Role::centre_density, 1);
  const auto of_faces = [](Points points, Surface surface, const GroundTruth& truth) {
    return centre_density(face_centroids(points, surface), truth);
  };
  shape.centre_density =
      shape.on_faces ? table.add(shape.level, head, of_faces, shape.points, shape.surface, shape.ground_truth)
                     : table.add(shape.level, head, centre_density, shape.points, shape.ground_truth);
  shape.centre_densities =
      table.add(shape.level, stage(Role::centre_densities, 1), sum_of_densities, shape.centre_density);
}

Output<Scores> add_model(RuleTable& table, const ShapeOutputs& shape, const Config& config,
                         const MetricsOptions& smoothing, const Model& model) {
  const auto match = [](const ScalarField& values, const Histogram& reference) {
    return matched(values, reference);
  };
  const Output<ScalarField> map = add_face_map(table, shape, model, model.add_map(table, shape));
  if (!smoothing.smoothing.empty()) add_smoothed_scores(table, shape, smoothing, model, map);
  const bool is_matched = model.given && model.given->matched;
  const bool is_read = MetricsByMatching(config.metrics).any(Matching::histogram);
  const Output<ScalarField> matched_map =
      is_matched || !is_read
          ? map
          : table.add(shape.level, stage_of(model.name, Role::matched, 1), match, map, shape.reference);
  const Output<Scores> scores = add_scores(table, shape, config, model, map, matched_map);
  if (is_matched) return scores;
  table.add(shape.level, stage_of(model.name, Role::mean_histogram, 1), mean_over<ScalarField>, map);
  return scores;
}

Output<Scores> add_constant_scores(RuleTable& table, const ShapeOutputs& shape, const Config& config) {
  MetricsOptions varying = config.metrics;
  varying.names.clear();
  varying.matching.clear();  // every matching gives the same constant map
  for (const Metric& metric : chosen_metrics(config.metrics))
    if (metric.constant_varies) varying.names.push_back(metric.name);
  if (varying.names.empty()) return {};
  const std::vector<Metric> metrics = chosen_metrics(varying);
  return table.add(
      shape.level, stage_of(std::string(kConstantMap), Role::scores, scores_version(metrics)),
      [metrics, faces = shape.on_faces](const ScoredShape& scored, const MetricsOptions& options) {
        const ScalarField constant(faces ? scored.surface.size() : scored.points.size(), 0.5);
        return score(metrics, constant, scored.truth, options, Rng(0, "", ""),
                     measures_on(faces, metrics, constant.size(), scored));
      },
      together<ScoredShape>(shape.ground_truth, shape.points,
                            only_if(shape.on_faces || any_of_faces(metrics), shape.surface)),
      section("metrics", varying));
}

void add_score_tables(RuleTable& table, const std::vector<Scored>& scored) {
  for (const auto& [level, model, scores] : scored)
    table.add(level, stage_of(model, Role::score_table, 1), score_table, scores);
}

}  // namespace salbench
