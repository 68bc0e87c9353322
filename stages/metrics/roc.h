// SPDX-License-Identifier: GPL-3.0-or-later
// Areas under ROC curves. Positives are the picks, or the points of highest ground truth.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stages/metrics/comparison.h"

namespace salbench {

// --- of picks, against the points that nobody picked. By area, negatives are the whole surface: a pick is a
// point, which has no area to leave out.

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

// --- against points that people mark on other shapes

// Probability that a pick has a larger value than a negative, ties one half; a point is a negative with its
// weight times `negatives`, n values >= 0, whether it was picked or not. No sampling; O(n log n). NaN without
// picks, and without negatives. [tatler2005]
double shuffled_auc(std::span<const double> map, std::span<const std::int32_t> picked,
                    std::span<const double> negatives, const Measure& measure);

// --- against negatives that are drawn at random, averaged over splits: in each of them as many as there are
// picks. A curve runs from (1, 1) over the rates of values >= each threshold to (0, 0).

struct Splits {
  std::int32_t count;       // draws that the area is averaged over
  std::int32_t thresholds;  // of even ones
};

// Every tenth of the map's range. [borji2013]
std::vector<double> tenths_of_range(const Distribution& map);

// Without thresholds, those of a split are even, from 0 to the largest value among its picks and negatives
// [tasse2016]. `picks` are the values at the picked points. NaN without picks, and without negatives.
double sampled_auc(std::span<const double> picks, RandomValues& negatives, const Splits& splits,
                   const std::vector<double>& thresholds = {});

// --- with the points of highest ground truth as positives, as work without picks does: the upper 20, 10, 5
// or 1 %

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
