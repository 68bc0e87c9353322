// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stages/core/check.h"
#include "stages/core/field.h"

namespace salbench {
namespace {

template <class T, class Make>
const T& once(std::optional<T>& value, const Make& make) {
  if (!value) value = make();
  return *value;
}

}  // namespace

double correlation(std::span<const double> a, const Moments& of_a, std::span<const double> b,
                   const Moments& of_b, const Measure& measure) {
  CHECK_EQ(a.size(), b.size());
  if (measure.empty()) return std::numeric_limits<double>::quiet_NaN();
  if (of_a.constant || of_b.constant) return 0;
  double products = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    products += measure.weight[i] * (a[i] - of_a.mean) * (b[i] - of_b.mean);
  return products / (std::sqrt(of_a.squares) * std::sqrt(of_b.squares));
}

Comparison::Comparison(std::span<const double> map, std::span<const double> saliency,
                       std::span<const double> areas, const Rng& rng)
    : map_(map), saliency_(saliency), areas_(areas), uniform_draws_(rng), value_draws_(map, rng) {}

const Measure& Comparison::measure(Weighting weighting) const {
  return once(of(weighting).measure, [&] {
    return weighting == Weighting::vertex ? vertex_measure(map_.size()) : area_measure(areas_);
  });
}

const Distribution& Comparison::map_distribution(Weighting weighting) const {
  return once(of(weighting).map, [&] {
    return distribution(map_, once(map_order_, [&] { return ascending_order(map_); }), measure(weighting));
  });
}

const Order& Comparison::saliency_order() const {
  return once(saliency_order_, [&] { return ascending_order(saliency_); });
}

const Moments& Comparison::map_moments(Weighting weighting) const {
  return once(of(weighting).map_moments, [&] { return moments(map_, measure(weighting)); });
}

const ScalarField& Comparison::normalised_map() const {
  return once(normalised_map_, [&] { return min_max_normalised(map_); });
}

const TopScores& Comparison::top_scores(Weighting weighting) const {
  return once(of(weighting).top, [&] {
    return salbench::top_scores(
        {map_, map_distribution(weighting), map_moments(weighting), saliency_, saliency_order()},
        measure(weighting));
  });
}

double Comparison::cc(Weighting weighting) const {
  return once(of(weighting).cc, [&] {
    const Measure& over = measure(weighting);
    return correlation(map_, map_moments(weighting), saliency_, moments(saliency_, over), over);
  });
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
  std::vector<double> areas = quantile_aucs(curves, values_at(map_, picked), uniform_draws_, splits);
  areas.resize(3, undefined);
  return quantile_areas_
      .emplace_back(OfPicks{{picked.begin(), picked.end()}, splits, {areas[2], {areas[0], areas[1]}}})
      .areas;
}

double Comparison::spearman(Weighting weighting) const {
  const Measure& over = measure(weighting);
  const ScalarField& of_map = map_distribution(weighting).mid;
  const ScalarField of_saliency = distribution(saliency_, saliency_order(), over).mid;
  return correlation(of_map, moments(of_map, over), of_saliency, moments(of_saliency, over), over);
}

}  // namespace salbench
