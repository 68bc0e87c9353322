// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/comparison.h"

#include <algorithm>
#include <limits>

#include "stages/core/field.h"
#include "stages/metrics/shuffled_roc.h"

namespace salbench {
namespace {

std::size_t slot(Weighting weighting) { return static_cast<std::size_t>(weighting); }

template <class T, class Make>
const T& once(std::optional<T>& value, const Make& make) {
  if (!value) value = make();
  return *value;
}

}  // namespace

const Distribution& Comparison::map_distribution(Weighting weighting) const {
  return once(map_distributions_[slot(weighting)], [&] {
    const Order& order = once(map_order_, [&] { return ascending_order(compared_.map); });
    return distribution(compared_.map, order, measure(weighting));
  });
}

const Order& Comparison::saliency_order() const {
  return once(saliency_order_, [&] { return ascending_order(compared_.saliency); });
}

const PairMoments& Comparison::with_saliency(Weighting weighting) const {
  return once(with_saliency_[slot(weighting)],
              [&] { return pair_moments(compared_.map, compared_.saliency, measure(weighting)); });
}

const Moments& Comparison::map_moments(Weighting weighting) const {
  if (!compared_.saliency.empty()) return with_saliency(weighting).a;
  return once(map_moments_[slot(weighting)], [&] { return moments(compared_.map, measure(weighting)); });
}

const ScalarField& Comparison::normalised_map() const {
  return once(normalised_map_, [&] { return min_max_normalised(compared_.map); });
}

std::span<const double> Comparison::floored(std::span<const double> map,
                                            std::optional<ScalarField>& kept) const {
  if (compared_.floor == 0) return map;
  return once(kept, [&] {
    ScalarField raised(map.begin(), map.end());
    for (double& value : raised) value = std::max(value, compared_.floor);
    return raised;
  });
}

Distributed Comparison::map_distributed(Weighting weighting) const {
  return {density_map(), density_of_map(density_map(), measure(weighting))};
}

Distributed Comparison::uniform(Weighting weighting) const {
  return {compared_.map, {0, measure(weighting).unit / measure(weighting).total}};
}

Distributed Comparison::centre_bias(Weighting weighting) const {
  const ScalarField& bias = compared_.measures.centre_bias;
  if (bias.empty()) return {};
  return {bias, density_of_map(bias, measure(weighting))};
}

double Comparison::divergence(Weighting weighting, const DivergenceFloors& floors) const {
  return salbench::divergence(density_map(), compared_.raw_saliency, floors, measure(weighting));
}

double Comparison::sim(Weighting weighting) const {
  return similarity(density_map(), compared_.raw_saliency, measure(weighting));
}

double Comparison::sim_of_normalised(Weighting weighting) const {
  return similarity(floored(normalised_map(), floored_normalised_map_), compared_.saliency,
                    measure(weighting));
}

double Comparison::mean_error(Weighting weighting, double (*error)(double difference)) const {
  return salbench::mean_error(normalised_map(), compared_.saliency, error, measure(weighting));
}

const TopScores& Comparison::top_scores(Weighting weighting) const {
  return once(top_scores_[slot(weighting)], [&] {
    return salbench::top_scores({compared_.map, map_distribution(weighting), map_moments(weighting),
                                 compared_.saliency, saliency_order()},
                                measure(weighting));
  });
}

double Comparison::cc(Weighting weighting) const { return correlation(with_saliency(weighting)); }

double Comparison::spearman(Weighting weighting) const {
  const Distribution saliency = distribution(compared_.saliency, saliency_order(), measure(weighting));
  return correlation(pair_moments(map_distribution(weighting).mid, saliency.mid, measure(weighting)));
}

double Comparison::cosine(Weighting weighting) const {
  return salbench::cosine(compared_.map, compared_.raw_saliency, measure(weighting));
}

double Comparison::shuffled_auc(std::span<const std::int32_t> picked, Weighting weighting) const {
  return salbench::shuffled_auc(compared_.map, picked, compared_.measures.negatives, measure(weighting));
}

bool Comparison::has_surface() const {
  return compared_.measures.surface && !compared_.measures.surface->edges.neighbours.empty();
}

const InterestPointScores& Comparison::interest_points(std::span<const std::int32_t> picked,
                                                       const LocalMaximaOptions& options,
                                                       double tolerance) const {
  return once(of(picked).interest_points, [&] {
    const SurfaceGraph& surface = *compared_.measures.surface;
    const auto& detected = once(detected_, [&] { return local_maxima(normalised_map(), surface, options); });
    return interest_point_scores(detected, picked, surface, tolerance);
  });
}

// Picks that are all distinct are the same with multiplicity.
Comparison::OfPicks& Comparison::of(std::span<const std::int32_t> picked) const {
  for (OfPicks& known : of_picks_)
    if (std::ranges::equal(known.picked, picked)) return known;
  return of_picks_.emplace_back(OfPicks{{picked.begin(), picked.end()}});
}

const std::vector<PickGroup>& Comparison::pick_groups(std::span<const std::int32_t> picked) const {
  return once(of(picked).groups, [&] { return salbench::pick_groups(compared_.map, picked); });
}

}  // namespace salbench
