// SPDX-License-Identifier: GPL-3.0-or-later
// Fields in ascending order, for rank statistics and ROC curves.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

// Points by ascending value, ties by index. Checks that no value is NaN.
using Order = std::vector<std::uint32_t>;
Order ascending_order(std::span<const double> field);

struct MidRanks {
  ScalarField below;  // by point, n: weight of smaller values, plus half the weight of equal ones
  double total = 0;   // total weight
};
// `weights`: n, >= 0.
MidRanks mid_ranks(std::span<const double> field, const Order& order, std::span<const double> weights);

}  // namespace salbench
