// SPDX-License-Identifier: GPL-3.0-or-later
// Scores with the points of highest ground truth as positives, as work without picks does: the upper 20, 10,
// 5 or 1 %.
#pragma once

#include <span>

#include "stages/metrics/distribution.h"
#include "stages/metrics/measure.h"
#include "stages/metrics/moments.h"

namespace salbench {

// Positives are the points on top, negatives all others, both weighed. A point is on top if less than that
// part of the shape has a higher ground truth; of equal values all or none are, and those at the minimum
// never are. NaN for a constant ground truth and over nothing.
struct TopScore {
  double auc = kUndefined;  // probability that a point on top has a larger value than another, ties one half
  // Weighted mean of (value - mean) over the top, in deviations; not finite for a constant map.
  double nss = kUndefined;
};

struct TopInput {
  std::span<const double> map;           // n
  const Distribution& map_distribution;  // the map's
  const Moments& map_moments;
  std::span<const double> saliency;  // n
  const Order& saliency_order;       // ascending
};
TopScore top_score(const TopInput& in, int percent, const Measure& measure);

}  // namespace salbench
