// SPDX-License-Identifier: GPL-3.0-or-later
// The distribution of a field's values over a shape: what rank statistics and ROC curves read.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

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

}  // namespace salbench
