// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/comparison.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "stages/core/field.h"

namespace salbench {
namespace {

template <class T, class Make>
T& once(std::optional<T>& value, const Make& make) {
  if (!value) value = make();
  return *value;
}

ScalarField floored(std::span<const double> map, double floor) {
  ScalarField raised(map.begin(), map.end());
  for (double& value : raised) value = std::max(value, floor);
  return raised;
}

}  // namespace

const Order& Comparison::map_order() const {
  return once(map_order_, [&] { return ascending_order(of.map); });
}

const Moments& Comparison::map_moments() const {
  if (!of.raw_saliency.empty()) return with_saliency().a;
  return once(map_moments_, [&] { return moments(of.map); });
}

RandomValues& Comparison::values_at_points(const Rng& rng) const {
  return once(values_at_points_, [&] { return values_at_random_points(of.map, rng); });
}

RandomValues& Comparison::quantiles(const Rng& rng) const {
  return once(quantiles_, [&] {
    std::vector<double> sorted;
    for (const std::uint32_t i : map_order()) sorted.push_back(of.map[i]);
    return random_quantiles(std::move(sorted), rng);
  });
}

const ScalarField& Comparison::normalised_map() const {
  return once(normalised_map_, [&] { return min_max_normalised(of.map); });
}

std::span<const double> Comparison::density_map() const {
  if (of.floor == 0) return of.map;
  return once(density_map_, [&] { return floored(of.map, of.floor); });
}

std::span<const double> Comparison::normalised_density_map() const {
  if (of.floor == 0) return normalised_map();
  return once(normalised_density_map_, [&] { return floored(normalised_map(), of.floor); });
}

const ScalarField& Comparison::saliency() const {
  return once(saliency_, [&] { return min_max_normalised(of.raw_saliency); });
}

const PairMoments& Comparison::with_saliency() const {
  return once(with_saliency_, [&] { return pair_moments(of.map, saliency()); });
}

const Order& Comparison::saliency_order() const {
  return once(saliency_order_, [&] { return ascending_order(saliency()); });
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
