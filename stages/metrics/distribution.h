// SPDX-License-Identifier: GPL-3.0-or-later
// The distribution of a field's values over a shape: what rank statistics and ROC curves read.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "stages/core/rng.h"
#include "stages/core/types.h"
#include "stages/metrics/measure.h"

namespace salbench {

// The points by ascending value, equal values by index. No value is NaN, which is checked.
using Order = std::vector<std::uint32_t>;
Order ascending_order(std::span<const double> field);

struct Distribution {
  ScalarField mid;  // by point, n: weight of smaller values, and half the weight of equal ones
  // By value, ascending, n each.
  std::vector<double> values;
  std::vector<double> reached;  // weight up to this value; of equal values, the first ones count first

  double total() const { return reached.empty() ? 0 : reached.back(); }
  double weight_below(double value) const;  // of smaller values. O(log n).
  // The value that a part u in [0, 1) of the weight lies at or below. O(log n).
  double quantile(double u) const;
};

Distribution distribution(std::span<const double> field, const Order& order, const Measure& measure);

// Values of a map, drawn at random: a longer sequence begins with a shorter one. The map outlives it.
class RandomValues {
 public:
  // At points drawn uniformly, with replacement, from all but the first; none of a single point.
  RandomValues(std::span<const double> map, Rng rng);
  // Quantiles of uniform numbers: so the draws depend neither on the numbering of the points nor, by area, on
  // how the surface is divided into faces. None of a distribution over nothing.
  RandomValues(const Distribution& map, Rng rng);

  bool none() const { return next_ == nullptr; }
  std::span<const double> first(std::size_t count);

 private:
  std::function<double()> next_;
  ScalarField values_;  // so far
};

}  // namespace salbench
