// SPDX-License-Identifier: GPL-3.0-or-later
// A map and a ground truth, with quantities that several metrics need, each computed on first use. The value
// of a metric does not depend on other metrics computed before.
#pragma once

#include <optional>
#include <span>

#include "stages/metrics/interest_points.h"
#include "stages/metrics/measure.h"
#include "stages/metrics/moments.h"
#include "stages/metrics/ranks.h"
#include "stages/metrics/roc.h"

namespace salbench {

// The map and the ground truth to compare. The arrays must outlive the comparison.
struct Compared {
  std::span<const double> map;                // n
  std::span<const double> raw_saliency = {};  // n, the ground truth as marked by people; may be empty
  const Measures& measures;                   // measures of the shape
  double floor = 0;                           // least value of the map in [0, 1] when read as a density
};

// Not thread-safe.
class Comparison {
 public:
  explicit Comparison(const Compared& compared) : of(compared) {}

  const Compared of;

  const Order& map_order() const;
  const Moments& map_moments() const;
  const ScalarField& normalised_map() const;    // min-max
  std::span<const double> density_map() const;  // not below the floor, like the following:
  std::span<const double> normalised_density_map() const;
  const ScalarField& saliency() const;  // min-max-normalised; empty if unknown
  // Both expect the same `rng` each time.
  RandomValues& values_at_points(const Rng& rng) const;
  RandomValues& quantiles(const Rng& rng) const;
  // These need saliency values.
  const PairMoments& with_saliency() const;
  const Order& saliency_order() const;
  // Requires a surface, and the same arguments each time. `picked`: with multiplicity.
  const InterestPointScores& interest_points(std::span<const std::int32_t> picked,
                                             const LocalMaximaOptions& options, double tolerance) const;

 private:
  mutable std::optional<Order> map_order_, saliency_order_;
  mutable std::optional<ScalarField> normalised_map_, density_map_, normalised_density_map_, saliency_;
  mutable std::optional<RandomValues> values_at_points_, quantiles_;
  mutable std::optional<Moments> map_moments_;        // without saliency
  mutable std::optional<PairMoments> with_saliency_;  // map and saliency
  mutable std::optional<InterestPointScores> interest_points_;
};

}  // namespace salbench
