// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/comparison.h"

#include <algorithm>

#include "stages/core/field.h"

namespace salbench {
namespace {

std::size_t slot(Weighting weighting) { return static_cast<std::size_t>(weighting); }

template <class T, class Make>
T& once(std::optional<T>& value, const Make& make) {
  if (!value) value = make();
  return *value;
}

ScalarField floored(std::span<const double> map, double floor) {
  ScalarField raised(map.begin(), map.end());
  if (floor != 0)
    for (double& value : raised) value = std::max(value, floor);
  return raised;
}

}  // namespace

const Distribution& Comparison::map_distribution(Weighting weighting) const {
  return once(map_distributions_[slot(weighting)], [&] {
    const Order& order = once(map_order_, [&] { return ascending_order(of.map); });
    return distribution(of.map, order, measure(weighting));
  });
}

const Moments& Comparison::map_moments(Weighting weighting) const {
  if (!of.saliency.empty()) return with_saliency(weighting).a;
  return once(map_moments_[slot(weighting)], [&] { return moments(of.map, measure(weighting)); });
}

RandomValues& Comparison::random_values(const Rng& rng) const {
  return once(random_values_, [&] { return RandomValues(of.map, rng); });
}

RandomValues& Comparison::random_quantiles(Weighting weighting, const Rng& rng) const {
  return once(random_quantiles_[slot(weighting)],
              [&] { return RandomValues(map_distribution(weighting), rng); });
}

const ScalarField& Comparison::normalised_map() const {
  return once(normalised_map_, [&] { return min_max_normalised(of.map); });
}

const ScalarField& Comparison::density_map() const {
  return once(density_map_, [&] { return floored(of.map, of.floor); });
}

const ScalarField& Comparison::normalised_density_map() const {
  return once(normalised_density_map_, [&] { return floored(normalised_map(), of.floor); });
}

const PairMoments& Comparison::with_saliency(Weighting weighting) const {
  return once(with_saliency_[slot(weighting)],
              [&] { return pair_moments(of.map, of.saliency, measure(weighting)); });
}

const Order& Comparison::saliency_order() const {
  return once(saliency_order_, [&] { return ascending_order(of.saliency); });
}

const InterestPointScores& Comparison::interest_points(std::span<const std::int32_t> picked,
                                                       const LocalMaximaOptions& options,
                                                       double tolerance) const {
  return once(interest_points_, [&] {
    const SurfaceGraph& surface = *of.measures.surface;
    return interest_point_scores(local_maxima(normalised_map(), surface, options), picked, surface,
                                 tolerance);
  });
}

}  // namespace salbench
