// SPDX-License-Identifier: GPL-3.0-or-later
// Area under the ROC curve against points that people mark on other shapes.
#pragma once

#include <cstdint>
#include <span>

#include "stages/metrics/measure.h"

namespace salbench {

// Probability that a pick has a larger value than a negative, ties one half; a point is a negative with its
// weight times `negatives`, n values >= 0, whether it was picked or not. No sampling; O(n log n). NaN without
// picks, and without negatives. [tatler2005]
double shuffled_auc(std::span<const double> map, std::span<const std::int32_t> picked,
                    std::span<const double> negatives, const Measure& measure);

}  // namespace salbench
