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

#include "stages/metrics/density.h"
#include "stages/metrics/distribution.h"
#include "stages/metrics/draws.h"
#include "stages/metrics/measure.h"
#include "stages/metrics/moments.h"
#include "stages/metrics/sampled_roc.h"
#include "stages/metrics/top.h"

namespace salbench {

// The map and the ground truth to compare. The arrays must outlive the comparison.
struct Compared {
  std::span<const double> map;                // n
  std::span<const double> saliency = {};      // n, the ground truth, min-max-normalised; may be empty
  std::span<const double> raw_saliency = {};  // the same as people marked it
  std::span<const double> areas = {};         // n, of the points; may be empty
};

// Not for several threads.
class Comparison {
 public:
  // The draws may be shared with other comparisons, and outlive them.
  Comparison(const Compared& compared, Draws& draws) : compared_(compared), draws_(draws) {}

  const Measure& measure(Weighting weighting) const;
  const Distribution& map_distribution(Weighting weighting) const;
  const Moments& map_moments(Weighting weighting) const;
  const Density& map_density(Weighting weighting) const;
  // These need saliency values.
  const DensityScores& density_scores(Weighting weighting) const;
  const TopScores& top_scores(Weighting weighting) const;
  double cc(Weighting weighting) const;
  double spearman(Weighting weighting) const;  // cc of the mid-ranks, 0 where one is constant
  // Areas under the curves of some picks whose negatives are quantiles, all of them at once.
  struct QuantileAreas {
    double even_by_area;
    std::array<double, 2> tenths;  // [weighting]
  };
  const QuantileAreas& quantile_areas(std::span<const std::int32_t> picked, const Splits& splits) const;
  ValueDraws& value_draws() const { return value_draws_; }

 private:
  const PairMoments& with_saliency(Weighting weighting) const;
  const Order& saliency_order() const;
  const ScalarField& normalised_map() const;  // min-max

  struct Lazy {
    std::optional<Measure> measure;
    std::optional<Distribution> map;
    std::optional<Moments> map_moments;        // without saliency
    std::optional<PairMoments> with_saliency;  // of map and saliency
    std::optional<Density> map_density;
    std::optional<DensityScores> density_scores;
    std::optional<TopScores> top;
  };
  Lazy& of(Weighting weighting) const { return lazy_[static_cast<std::size_t>(weighting)]; }

  struct OfPicks {
    std::vector<std::int32_t> picked;
    Splits splits;
    QuantileAreas areas;
  };

  Compared compared_;
  Draws& draws_;
  mutable std::optional<Order> map_order_, saliency_order_;
  mutable std::optional<ScalarField> normalised_map_;
  mutable std::array<Lazy, 2> lazy_;
  mutable std::deque<OfPicks> quantile_areas_;
  mutable ValueDraws value_draws_{compared_.map, draws_};
};

}  // namespace salbench
