// SPDX-License-Identifier: GPL-3.0-or-later
// The distribution of a field's values over a shape: what rank statistics and ROC curves read.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/types.h"
#include "stages/metrics/measure.h"

namespace salbench {

// The points by ascending value, equal values by index. No value is NaN, which is checked.
using Order = std::vector<std::uint32_t>;
Order ascending_order(std::span<const double> field);

// By point: weight of the points with a smaller value, and half the weight of those with an equal one.
struct MidRanks {
  ScalarField by_vertex, by_area;  // n; none by area if the areas are not known
};
MidRanks mid_ranks(std::span<const double> field, const Order& order, const Measures& measures);

struct Distribution {
  ScalarField mid;  // by point, n
  // By value, ascending, n each.
  std::vector<double> values;
  std::vector<double> reached;  // weight up to this value; of equal values, the first ones count first

  double total() const { return reached.empty() ? 0 : reached.back(); }
  std::size_t points_below(double value) const;  // with a smaller value. O(log n).
  double weight_of(std::size_t points) const {
    return points == 0 ? 0 : reached[points - 1];
  }  // of the first
  double weight_below(double value) const { return weight_of(points_below(value)); }
  // The value that a part u in [0, 1) of the weight lies at or below. O(log n).
  double quantile(double u) const;
};

// [weighting]; empty by area if the areas are not known.
std::array<Distribution, 2> distributions(std::span<const double> field, const Order& order,
                                          const Measures& measures);

}  // namespace salbench
