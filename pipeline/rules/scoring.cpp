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

// Saliency where it is known.
ScalarField seen_values(const GroundTruth& truth) {
  const auto seen = seen_points(truth.saliency);
  return seen ? values_at(truth.saliency, *seen) : truth.saliency;
}
const ScalarField& seen_values(const ScalarField& map) { return map; }

// Serial and in the order of the items: sums of doubles depend on their order.
template <class T>
Histogram mean_over(const Members<T>& members) {
  std::vector<Histogram> histograms;
  for (std::size_t i = 0; i < members.size; ++i) {
    const auto member = members[i];
    const auto& values = seen_values(*member);
    // A scan may show nothing known. An infinite value fails stages of its own item, and nothing here.
    if (!values.empty() && std::ranges::none_of(values, [](double value) { return std::isinf(value); }))
      histograms.push_back(normalised_histogram(values));
  }
  return mean_histogram(histograms);
}

CentreDensity sum_of_densities(const Members<CentreDensity>& members) {
  CentreDensity sum;
  for (std::size_t i = 0; i < members.size; ++i) add(sum, *members[i]);
  return sum;
}

ScoreTable score_table(const Members<Scores>& members) {
  ScoreTable table;
  for (std::size_t i = 0; i < members.size; ++i) table.rows.push_back(*members[i]);
  return table;
}

ScoreTable one_after_the_other(const Members<ScoreTable>& members) {
  ScoreTable table;
  for (std::size_t i = 0; i < members.size; ++i) {
    const auto member = members[i];
    table.rows.insert(table.rows.end(), member->rows.begin(), member->rows.end());
  }
  return table;
}

// Ground truth that a map is compared with, and the parts of the shape that the metrics read.
struct ScoredShape {
  using Parameters = std::tuple<GroundTruth, Points, Surface>;
  const GroundTruth& truth;
  Points points;
  Surface surface;
};
// Ground truth by the distance from the centroid; null where no metric asks for it.
struct Densities {
  using Parameters = std::tuple<const CentreDensity*, const CentreDensity*>;
  const CentreDensity *own, *of_set;
};

// Measures of what is scored: points of a shape, or faces of a mesh.
Measures measures_on(bool faces, std::span<const Metric> metrics, std::size_t n, Points points,
                     Surface surface, const Densities& densities = {}) {
  const auto& [own, of_set] = densities;
  if (!faces) return measures_of(metrics, n, points, surface, density_if_known(points, own, of_set));
  const std::vector<Vec3> centroids = face_centroids(points, surface);
  Measures measures{.size = n, .negatives = density_if_known(centroids, own, of_set)};
  if (any_reads(metrics, Reads::areas)) measures.areas = face_areas(points, surface);
  if (any_reads(metrics, Reads::positions)) measures.centre_bias = distances_from_centroid(centroids);
  return measures;
}

// The map as it is scored.
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

// Reads the map in the readings that the metrics ask for, and the surface where one weighs by area: other
// scores are found whatever these are.
Output<Scores> add_scores(RuleTable& table, const ShapeOutputs& shape, const Config& config,
                          const Model& model, const Output<FieldView>& map,
                          const Output<FieldView>& matched_map) {
  const auto metrics = std::make_shared<const MetricsByMatching>(config.metrics);
  const bool positions = any_of_points(metrics->all());
  return table.add(
      shape.level, stage_of(model.name, Role::scores, scores_version(metrics->all())),
      [metrics, faces = shape.on_faces](FieldView matched_values, FieldView values, const ScoredShape& scored,
                                        const Densities& densities, const MetricsOptions& options,
                                        const RandomSource& random) {
        const Rng draws = draws_of_scores(random);
        const std::size_t n = std::max(matched_values.size(), values.size());
        const Measures measures =
            measures_on(faces, metrics->all(), n, scored.points, scored.surface, densities);
        return metrics->score([&](std::span<const Metric> of_part, Matching read) -> Scores {
          if (read == Matching::histogram)
            return score(of_part, matched_values, scored.truth, options, draws, measures);
          return score(of_part, unmatched(values, read), scored.truth, options, draws, measures);
        });
      },
      only_if(metrics->any(Matching::histogram), matched_map), only_if(metrics->any_unmatched(), map),
      together<ScoredShape>(
          shape.ground_truth, only_if(positions, shape.points),
          only_if(shape.on_faces ? positions : any_of_faces(metrics->all()), shape.surface)),
      together<Densities>(shape.centre_density, shape.centre_densities), section("metrics", config.metrics),
      kRandom);
}

// The scores of a map after each number of smoothing steps, with the draws of the plain scores. They stand
// beside all else, and nothing reads them.
void add_smoothed_scores(RuleTable& table, const ShapeOutputs& shape, const MetricsOptions& chosen,
                         const Model& model, const Output<FieldView>& map) {
  const auto metrics = std::make_shared<const MetricsByMatching>(chosen);
  const bool match = metrics->any(Matching::histogram) && !(model.given && model.given->matched);
  const auto tables = table.add(
      shape.level, stage_of(model.name, Role::smoothed_scores, scores_version(metrics->all())),
      [metrics, faces = shape.on_faces](FieldView plain, const ScoredShape& scored,
                                        const Histogram* reference, const Densities& densities,
                                        const MetricsOptions& options, const RandomSource& random) {
        const Points points = scored.points;
        const Surface surface = scored.surface;
        const Measures measures =
            measures_on(faces, metrics->all(), plain.size(), points, surface, densities);
        const Adjacency adjacency =
            faces ? face_adjacency(points.size(), surface) : edge_adjacency(points.size(), surface);
        ScalarField values(plain.begin(), plain.end());
        for (double& value : values)
          if (std::isnan(value)) value = 0;  // as matching and normalisation have it
        ScoreTable by_steps;
        std::int32_t done = 0;
        for (const std::int32_t steps : smoothing_steps(options)) {
          values = smoothed_by_steps(std::move(values), adjacency, steps - std::exchange(done, steps));
          const Rng draws = draws_of_scores(random);
          by_steps.rows.push_back(
              metrics->score([&](std::span<const Metric> of_part, Matching read) -> Scores {
                const bool to_match = read == Matching::histogram && reference != nullptr;
                return score(of_part, to_match ? matched(values, *reference) : unmatched(values, read),
                             scored.truth, options, draws, measures);
              }));
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
  if (model.given && model.given->matched) return add_scores(table, shape, config, model, map, map);
  const Output<Scores> scores =
      add_scores(table, shape, config, model, map,
                 table.add(shape.level, stage_of(model.name, Role::matched, 1), match, map, shape.reference));
  table.add(shape.level, stage_of(model.name, Role::mean_histogram, 1), mean_over<ScalarField>, map);
  return scores;
}

Output<Scores> add_constant_scores(RuleTable& table, const ShapeOutputs& shape, const Config& config) {
  MetricsOptions varying = config.metrics;
  varying.names.clear();
  varying.matching.clear();  // a constant map is read alike in all forms
  for (const Metric& metric : chosen_metrics(config.metrics))
    if (metric.constant_varies) varying.names.push_back(metric.name);
  if (varying.names.empty()) return {};
  const auto metrics = std::make_shared<const std::vector<Metric>>(chosen_metrics(varying));
  return table.add(
      shape.level, stage_of(std::string(kConstantMap), Role::scores, scores_version(*metrics)),
      [metrics, faces = shape.on_faces](const GroundTruth& truth, Points points, Surface surface,
                                        const MetricsOptions& options) {
        const ScalarField constant(faces ? surface.size() : points.size(), 0.5);
        const Measures measures = measures_on(faces, *metrics, constant.size(), points, surface);
        return score(*metrics, constant, truth, options, Rng(0, "", ""), measures);
      },
      shape.ground_truth, shape.points, only_if(shape.on_faces || any_of_faces(*metrics), shape.surface),
      section("metrics", varying));
}

void add_score_tables(RuleTable& table, const std::vector<Scored>& scored) {
  for (const Scored& of : scored)
    table.add(of.level, stage_of(of.model, Role::score_table, 1), score_table, of.scores);
}

}  // namespace salbench
