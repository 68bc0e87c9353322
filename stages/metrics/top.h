// SPDX-License-Identifier: GPL-3.0-or-later
// Scores with the points of highest ground truth as positives, as work without picks does: the upper 20, 10,
// 5 or 1 %.
#pragma once

#include <array>
#include <span>

#include "stages/metrics/distribution.h"
#include "stages/metrics/measure.h"
#include "stages/metrics/moments.h"

namespace salbench {

inline constexpr std::array<int, 4> kTopPercents = {20, 10, 5, 1};

// Positives are the points on top, negatives all others, both weighed. A point is on top if less than that
// part of the shape has a higher ground truth; of equal values all or none are, and those at the minimum
// never are. All NaN for a constant ground truth and over nothing.
struct TopScores {
  // Probability that a point on top has a larger value of the map than another, ties one half.
  std::array<double, kTopPercents.size()> auc;
  // Weighted mean of (value - mean) over the top, in deviations; not finite for a constant map.
  std::array<double, kTopPercents.size()> nss;
};

struct TopInput {
  std::span<const double> map;           // n
  const Distribution& map_distribution;  // the map's
  const Moments& map_moments;
  std::span<const double> saliency;  // n
  const Order& saliency_order;       // ascending
};
TopScores top_scores(const TopInput& in, const Measure& measure);

}  // namespace salbench
