// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/comparison.h"

#include <algorithm>
#include <limits>

#include "stages/core/field.h"

namespace salbench {
namespace {

template <class T, class Make>
const T& once(std::optional<T>& value, const Make& make) {
  if (!value) value = make();
  return *value;
}

}  // namespace

const Measure& Comparison::measure(Weighting weighting) const {
  return once(of(weighting).measure, [&] {
    return weighting == Weighting::vertex ? vertex_measure(compared_.map.size())
                                          : area_measure(compared_.areas);
  });
}

const Distribution& Comparison::map_distribution(Weighting weighting) const {
  return once(of(weighting).map, [&] {
    return distribution(compared_.map, once(map_order_, [&] { return ascending_order(compared_.map); }),
                        measure(weighting));
  });
}

const Order& Comparison::saliency_order() const {
  return once(saliency_order_, [&] { return ascending_order(compared_.saliency); });
}

const PairMoments& Comparison::with_saliency(Weighting weighting) const {
  return once(of(weighting).with_saliency,
              [&] { return pair_moments(compared_.map, compared_.saliency, measure(weighting)); });
}

const Moments& Comparison::map_moments(Weighting weighting) const {
  if (!compared_.saliency.empty()) return with_saliency(weighting).a;
  return once(of(weighting).map_moments, [&] { return moments(compared_.map, measure(weighting)); });
}

const ScalarField& Comparison::normalised_map() const {
  return once(normalised_map_, [&] { return min_max_normalised(compared_.map); });
}

const Density& Comparison::map_density(Weighting weighting) const {
  return once(of(weighting).map_density, [&] { return density_of_map(compared_.map, measure(weighting)); });
}

const DensityScores& Comparison::density_scores(Weighting weighting) const {
  return once(of(weighting).density_scores, [&] {
    return salbench::density_scores(
        {compared_.map, compared_.raw_saliency, normalised_map(), compared_.saliency, map_density(weighting)},
        measure(weighting));
  });
}

const TopScores& Comparison::top_scores(Weighting weighting) const {
  return once(of(weighting).top, [&] {
    return salbench::top_scores({compared_.map, map_distribution(weighting), map_moments(weighting),
                                 compared_.saliency, saliency_order()},
                                measure(weighting));
  });
}

double Comparison::cc(Weighting weighting) const { return correlation(with_saliency(weighting)); }

double Comparison::spearman(Weighting weighting) const {
  const Measure& over = measure(weighting);
  const ScalarField of_saliency = mid_ranks(compared_.saliency, saliency_order(), over);
  return correlation(pair_moments(map_distribution(weighting).mid, of_saliency, over));
}

const Comparison::QuantileAreas& Comparison::quantile_areas(std::span<const std::int32_t> picked,
                                                            const Splits& splits) const {
  for (const OfPicks& known : quantile_areas_)
    if (std::ranges::equal(known.picked, picked) && known.splits == splits) return known.areas;
  const double undefined = std::numeric_limits<double>::quiet_NaN();
  std::vector<QuantileCurve> curves = {{map_distribution(Weighting::vertex), Thresholds::tenths}};
  if (!measure(Weighting::area).empty())
    for (const Thresholds thresholds : {Thresholds::tenths, Thresholds::even})
      curves.push_back({map_distribution(Weighting::area), thresholds});
  std::vector<double> areas = quantile_aucs(curves, values_at(compared_.map, picked), draws_, splits);
  areas.resize(3, undefined);
  return quantile_areas_
      .emplace_back(OfPicks{{picked.begin(), picked.end()}, splits, {areas[2], {areas[0], areas[1]}}})
      .areas;
}

}  // namespace salbench
