// SPDX-License-Identifier: GPL-3.0-or-later
// Areas under the ROC curve of the picks. Per vertex, negatives are the points that nobody picked. By area
// they are the whole surface: a pick is a point, which has no area to leave out.
#pragma once

#include <cstdint>
#include <span>

#include "stages/metrics/comparison.h"

namespace salbench {

// `picked` ascends and may hold a point several times: as many positives. All are NaN without picks, and
// without negatives or over an empty measure.

// Probability that a pick has a larger value than a negative, ties one half. O(n log n). [mann1947]
double auc_exact(std::span<const double> map, std::span<const std::int32_t> picked);  // per vertex
double auc_exact(std::span<const std::int32_t> picked, Weighting weighting, const Comparison& comparison);

// The same against all points, those that were picked among them.
double auc_of_all(std::span<const std::int32_t> picked, Weighting weighting, const Comparison& comparison);

// The curve through the rates at the values of the picks and at the ends, (0, 0) and (1, 1); linear in
// between, so with few picks it lies above auc_exact. [judd2009]
double auc_judd(std::span<const std::int32_t> picked, Weighting weighting, const Comparison& comparison);

}  // namespace salbench
