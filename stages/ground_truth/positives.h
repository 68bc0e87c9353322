// SPDX-License-Identifier: GPL-3.0-or-later
// Points that count as picked, for ground truth that is a density alone. NaN stands for what was not seen: it
// neither counts nor is counted.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace salbench {

// Both: ascending indices; none of a constant density. Equal values are all taken or none, and those at the
// minimum never are, so that no order of the points matters.

// Points that less than `percent` of the points seen lie above: those that auc_top20 has as positives.
std::vector<std::int32_t> points_on_top(std::span<const double> density, double percent);

std::vector<std::int32_t> points_above_mean(std::span<const double> density);

}  // namespace salbench
