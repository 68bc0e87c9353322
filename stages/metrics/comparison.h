// SPDX-License-Identifier: GPL-3.0-or-later
// A map and a ground truth, with what several metrics need of them computed once, when the first one asks.
// What a metric gets does not depend on which others were computed before it.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "stages/metrics/distribution.h"
#include "stages/metrics/draws.h"
#include "stages/metrics/measure.h"
#include "stages/metrics/sampled_roc.h"
#include "stages/metrics/top.h"

namespace salbench {

// Pearson correlation of two fields; 0 where one is constant, NaN over nothing.
double correlation(std::span<const double> a, const Moments& of_a, std::span<const double> b,
                   const Moments& of_b, const Measure& measure);

// Not for several threads. The fields outlive it.
class Comparison {
 public:
  // `saliency` is the ground truth, min-max-normalised, and `areas` those of the points; both may be empty.
  Comparison(std::span<const double> map, std::span<const double> saliency, std::span<const double> areas,
             const Rng& rng);

  const Measure& measure(Weighting weighting) const;
  const Distribution& map_distribution(Weighting weighting) const;
  const Moments& map_moments(Weighting weighting) const;
  const ScalarField& normalised_map() const;               // min-max
  const TopScores& top_scores(Weighting weighting) const;  // these need saliency values
  double cc(Weighting weighting) const;
  // Areas under the curves of some picks whose negatives are quantiles, all of them at once.
  struct QuantileAreas {
    double even_by_area;
    std::array<double, 2> tenths;  // [weighting]
  };
  const QuantileAreas& quantile_areas(std::span<const std::int32_t> picked, const Splits& splits) const;
  ValueDraws& value_draws() const { return value_draws_; }
  double spearman(Weighting weighting) const;  // cc of the mid-ranks, 0 where one is constant

 private:
  const Order& saliency_order() const;

  struct Lazy {
    std::optional<Measure> measure;
    std::optional<Distribution> map;
    std::optional<Moments> map_moments;
    std::optional<TopScores> top;
    std::optional<double> cc;
  };
  Lazy& of(Weighting weighting) const { return lazy_[static_cast<std::size_t>(weighting)]; }

  struct OfPicks {
    std::vector<std::int32_t> picked;
    Splits splits;
    QuantileAreas areas;
  };

  std::span<const double> map_, saliency_, areas_;
  mutable std::optional<Order> map_order_, saliency_order_;
  mutable std::optional<ScalarField> normalised_map_;
  mutable std::array<Lazy, 2> lazy_;
  mutable std::deque<OfPicks> quantile_areas_;
  mutable UniformDraws uniform_draws_;
  mutable ValueDraws value_draws_;
};

}  // namespace salbench
