// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/human.h"

#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/inputs/given_truth.h"
#include "pipeline/rules/scoring.h"
#include "stages/core/field.h"
#include "stages/core/seen.h"
#include "stages/matching/matching.h"
#include "stages/metrics/by_matching.h"
#include "stages/metrics/score.h"

namespace salbench {
namespace {

template <class Normalised>
ScalarField where_seen(const ScalarField& map, const Normalised& normalised) {
  const auto seen = seen_points(map);
  if (!seen) return normalised(map);
  ScalarField result = map;
  const ScalarField values = normalised(values_at(map, *seen));
  for (std::size_t i = 0; i < values.size(); ++i) result[static_cast<std::size_t>((*seen)[i])] = values[i];
  return result;
}

// For metrics on matched maps, a group's map is matched like a model's, and so is the map of the others,
// which serves as ground truth; other metrics use both as marked. Points unseen by either group are excluded.
GroupScorer group_scorer(const Mesh& mesh, const Histogram& reference, ScalarField negatives,
                         const MetricsOptions& options, const Rng& rng) {
  const auto metrics = std::make_shared<const MetricsByMatching>(options);
  // Common to all pairs of groups.
  const auto measures = std::make_shared<const Measures>(
      measures_of(metrics->all(), mesh.vertices.size(), mesh.vertices, mesh.faces, std::move(negatives)));
  return {metrics->all().size(), [=](const ScalarField& map, const GroundTruth& others) {
            return metrics->score([&](std::span<const Metric> of_part, Matching matching) -> Scores {
              const bool as_marked = matching != Matching::histogram;
              const auto match = [&](const ScalarField& values) { return matched(values, reference); };
              const auto leave = [&](const ScalarField& values) { return unmatched(values, matching); };
              const ScalarField of_group = as_marked ? where_seen(map, leave) : where_seen(map, match);
              GroundTruth truth{as_marked ? others.saliency : where_seen(others.saliency, match),
                                others.picks, others.simulated};
              for (std::size_t i = 0; i < of_group.size(); ++i)
                if (std::isnan(of_group[i])) truth.saliency[i] = of_group[i];
              return score(of_part, of_group, truth, options, rng, *measures);
            });
          }};
}

// Random stream of the subsets of people. Renaming it would change all draws.
constexpr std::string_view kSubsets = "curve.HS";

std::function<bool(const std::any&)> participants_of(const Config& config) {
  if (config.recorded())
    return [](const std::any& source) {
      const Item& item = item_of(source);
      return item.recorded >= kMinParticipants;
    };
  if (!config.simulated()) return [](const std::any& source) { return has_participants(item_of(source)); };
  const bool enough = static_cast<std::size_t>(config.simulation.participants) >= kMinParticipants;
  return [enough](const std::any&) { return enough; };
}

// Enters the key if participants have both picks and maps (hs.h): version 1.0 compared smoothed picks there,
// and its results must not be reused.
KeyText maps_of_people(const Config& config, const Units& units) {
  if (config.simulated()) return {};
  const bool with_picks = config.gaze.truth.picks == GazePicks::fixations;
  return {"people", [=, recorded = config.recorded()](Unit unit) -> std::optional<std::string> {
            const Item& item = item_of(units, unit);
            if (item.read_by == ReadBy::salbench) return {};
            const bool have_both =
                recorded ? with_picks : item.viewers >= kMinParticipants && item.viewers == item.participants;
            return have_both ? std::optional("compared by their maps") : std::nullopt;
          }};
}

}  // namespace

Output<Scores> add_human_performance(RuleTable& table, const ShapeOutputs& meshes, const Output<Mesh>& mesh,
                                     const Units& units, const Config& config, const Model& model) {
  const auto people = text_of(maps_of_people(config, units));
  const std::int32_t version =
      model.version + scores_version(chosen_metrics(config.metrics)) - 1;  // raised when either version is
  RuleHead scores = stage_of(model.name, Role::scores, version);
  RuleHead curve = stage_of(model.name, Role::curve, version);
  scores.applies = curve.applies = participants_of(config);
  const Output<Scores> scored = table.add(
      kMeshes, scores,
      [](const Mesh& shape, const GroundTruth& truth, const Histogram& reference, const CentreDensity* own,
         const CentreDensity* set, const MetricsOptions& options, const RandomSource& random,
         const UnitText&) {
        return leave_one_out(shape, truth,
                             group_scorer(shape, reference, density_if_known(shape.vertices, own, set),
                                          options, draws_of_scores(random)));
      },
      mesh, meshes.ground_truth, meshes.reference, meshes.centre_density, meshes.centre_densities,
      section("metrics", config.metrics), kRandom, people);
  table.add(
      kMeshes, curve,
      [](const Mesh& shape, const GroundTruth& truth, const Histogram& reference, const CentreDensity* own,
         const CentreDensity* set, const HsOptions& options, const MetricsOptions& metrics,
         const RandomSource& random, const UnitText&) {
        return human_curve(shape, truth, options,
                           group_scorer(shape, reference, density_if_known(shape.vertices, own, set), metrics,
                                        draws_of_scores(random)),
                           random.rng(kSubsets));
      },
      mesh, meshes.ground_truth, meshes.reference, meshes.centre_density, meshes.centre_densities,
      section("models." + model.name, *model.human), section("metrics", config.metrics), kRandom, people);
  return scored;
}

}  // namespace salbench
