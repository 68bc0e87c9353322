// SPDX-License-Identifier: GPL-3.0-or-later
// Fields in ascending order: what rank statistics and ROC curves read.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

// The points by ascending value, equal values by index. No value is NaN, which is checked.
using Order = std::vector<std::uint32_t>;
Order ascending_order(std::span<const double> field);

struct MidRanks {
  ScalarField below;  // by point, n: weight of smaller values, and half the weight of equal ones
  double total = 0;   // weight of all
};
// `weights`: n, >= 0.
MidRanks mid_ranks(std::span<const double> field, const Order& order, std::span<const double> weights);

}  // namespace salbench
