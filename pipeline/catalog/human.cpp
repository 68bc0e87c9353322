// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/catalog/human.h"

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/catalog/given_truth.h"
#include "stages/core/field.h"
#include "stages/core/mesh_ops.h"
#include "stages/core/seen.h"
#include "stages/matching/matching.h"

namespace salbench {
namespace {

ScalarField matched_where_seen(const ScalarField& map, const Histogram& reference) {
  const auto seen = seen_points(map);
  if (!seen) return matched(map, reference);
  ScalarField result = map;
  const ScalarField values = matched(values_at(map, *seen), reference);
  for (std::size_t i = 0; i < values.size(); ++i) result[static_cast<std::size_t>((*seen)[i])] = values[i];
  return result;
}

// A group's map is matched like a model's, and so is the map of the others, which stands for the ground
// truth. What either group has not seen is not compared.
GroupScorer group_scorer(const Mesh& mesh, const Histogram& reference, const MetricsOptions& options,
                         const Rng& rng) {
  const std::vector<Metric> metrics = chosen_metrics(options);
  // The same for every pair of groups.
  const auto measures = std::make_shared<const Measures>(
      mesh.vertices.size(),
      any_by_area(metrics) ? barycentric_areas(mesh.vertices, mesh.faces) : ScalarField{});
  const auto draws = std::make_shared<Draws>(rng);
  return {metrics.size(), [=](const ScalarField& map, const GroundTruth& others) {
            const ScalarField matched_map = matched_where_seen(map, reference);
            GroundTruth matched_others{matched_where_seen(others.saliency, reference), others.picks,
                                       others.simulated};
            for (std::size_t i = 0; i < matched_map.size(); ++i)
              if (std::isnan(matched_map[i])) matched_others.saliency[i] = matched_map[i];
            return score(metrics, matched_map, matched_others, options, *draws, *measures);
          }};
}

std::function<bool(const DatasetItem&)> participants_of(const Config& config) {
  if (!config.simulated()) return has_participants;
  const bool enough = static_cast<std::size_t>(config.simulation.participants) >= kMinParticipants;
  return [enough](const DatasetItem&) { return enough; };
}

}  // namespace

void add_human_performance(Catalog& catalog, const ShapeRows& meshes, const RowOf<Mesh>& mesh,
                           const Config& config, const Model& model) {
  const std::string scores = "scores." + model.name, curve = "curve." + model.name;
  const std::int32_t version =
      model.version + scores_version(chosen_metrics(config.metrics)) - 1;  // grows with either
  catalog.add(
      Shapes::meshes, {scores, version, participants_of(config)},
      [scores](const Mesh& shape_of, const GroundTruth& truth, const Histogram& reference,
               const MetricsOptions& options, const RandomSource& random) {
        return leave_one_out(shape_of, truth, group_scorer(shape_of, reference, options, random.rng(scores)));
      },
      mesh, meshes.ground_truth, meshes.reference, section("metrics", config.metrics), kRandom);
  catalog.add(
      Shapes::meshes, {curve, version, participants_of(config)},
      [scores, curve](const Mesh& shape_of, const GroundTruth& truth, const Histogram& reference,
                      const HsOptions& options, const MetricsOptions& metrics, const RandomSource& random) {
        return human_curve(shape_of, truth, options,
                           group_scorer(shape_of, reference, metrics, random.rng(scores)), random.rng(curve));
      },
      mesh, meshes.ground_truth, meshes.reference, section("models." + model.name, *model.human),
      section("metrics", config.metrics), kRandom);
}

}  // namespace salbench
