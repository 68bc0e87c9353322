// SPDX-License-Identifier: GPL-3.0-or-later
// A map and a ground truth, with what several metrics need of them computed once, when the first one asks.
// The value of a metric does not depend on which others were computed before it.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "stages/metrics/density.h"
#include "stages/metrics/distribution.h"
#include "stages/metrics/interest_points.h"
#include "stages/metrics/local_maxima.h"
#include "stages/metrics/measure.h"
#include "stages/metrics/moments.h"
#include "stages/metrics/picks.h"
#include "stages/metrics/top.h"

namespace salbench {

// The map and the ground truth to compare. The arrays must outlive the comparison.
struct Compared {
  std::span<const double> map;                // n
  std::span<const double> saliency = {};      // n, the ground truth, min-max-normalised; may be empty
  std::span<const double> raw_saliency = {};  // the same as people marked it
  const Measures& measures;                   // of the shape
  double floor = 0;                           // least value of the map where it is read as a density
};

// Not for several threads.
class Comparison {
 public:
  explicit Comparison(const Compared& compared) : compared_(compared) {}

  const Measure& measure(Weighting weighting) const { return compared_.measures[weighting]; }
  const Distribution& map_distribution(Weighting weighting) const;
  const Moments& map_moments(Weighting weighting) const;
  Distributed map_distributed(Weighting weighting) const;
  Distributed uniform(Weighting weighting) const;
  Distributed centre_bias(Weighting weighting) const;  // no distribution where it is not known
  // These need saliency values.
  double divergence(Weighting weighting, const DivergenceFloors& floors) const;
  double sim(Weighting weighting) const;
  double sim_of_normalised(Weighting weighting) const;
  double mean_error(Weighting weighting, double (*error)(double difference)) const;
  const TopScores& top_scores(Weighting weighting) const;
  double cc(Weighting weighting) const;
  double spearman(Weighting weighting) const;  // cc of the mid-ranks, 0 where one is constant
  double cosine(Weighting weighting) const;    // of the ground truth as people marked it
  const std::vector<PickGroup>& pick_groups(std::span<const std::int32_t> picked) const;
  double shuffled_auc(std::span<const std::int32_t> picked, Weighting weighting) const;
  // These need a surface, and the same options each time. `picked`: with multiplicity.
  bool has_surface() const;
  const InterestPointScores& interest_points(std::span<const std::int32_t> picked,
                                             const LocalMaximaOptions& options, double tolerance) const;

 private:
  const PairMoments& with_saliency(Weighting weighting) const;
  const Order& saliency_order() const;
  const ScalarField& normalised_map() const;  // min-max
  std::span<const double> floored(std::span<const double> map, std::optional<ScalarField>& kept) const;
  std::span<const double> density_map() const { return floored(compared_.map, floored_map_); }

  template <class T>
  using Both = std::array<std::optional<T>, 2>;  // [weighting]

  // Results for one list of picks, as far as they have been asked for.
  struct OfPicks {
    std::vector<std::int32_t> picked;
    std::optional<std::vector<PickGroup>> groups = {};
    std::optional<InterestPointScores> interest_points = {};
  };
  OfPicks& of(std::span<const std::int32_t> picked) const;

  Compared compared_;
  mutable std::optional<Order> map_order_, saliency_order_;
  mutable std::optional<ScalarField> normalised_map_, floored_map_, floored_normalised_map_;
  mutable std::optional<std::vector<std::int32_t>> detected_;  // interest points of the map
  mutable Both<Distribution> map_distributions_;
  mutable Both<Moments> map_moments_;        // without saliency
  mutable Both<PairMoments> with_saliency_;  // of map and saliency
  mutable Both<TopScores> top_scores_;
  mutable std::deque<OfPicks> of_picks_;
};

}  // namespace salbench
