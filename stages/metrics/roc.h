// SPDX-License-Identifier: GPL-3.0-or-later
// Areas under ROC curves. Positives and negatives are given by weights, n each, >= 0. All areas are NaN
// without positives, and without negatives.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "stages/core/rng.h"
#include "stages/metrics/measure.h"
#include "stages/metrics/ranks.h"

namespace salbench {

// Number of picks of each of n points.
ScalarField pick_counts(std::span<const std::int32_t> picked, std::size_t n);
// 1 where the weight is 0, else 0.
ScalarField all_others(std::span<const double> weights);
// 1 on the upper 20 % of a field, else 0: a point is on top if less than that share of the points have a
// higher value. Equal values are treated alike, and the minimum is never on top. [lavoue2018]
ScalarField upper_fifth(std::span<const double> field, const Order& order);

// Probability that a positive has a larger value than a negative, ties one half. [mann1947]
double mann_whitney(std::span<const double> field, const Order& order, std::span<const double> positives,
                    std::span<const double> negatives);

// Curve through the rates at the values of the positives and the ends, (0, 0) and (1, 1), linear in between;
// with few positives it therefore lies above mann_whitney. Weights are counts; negatives are all others.
// [judd2009]
double auc_judd(std::span<const double> map, const Order& order, std::span<const double> positives);

// --- against random negatives, averaged over splits, each with as many negatives as picks. A curve runs from
// (1, 1) over the rates of values >= each threshold to (0, 0).

// Random values of a map: a longer sequence begins with a shorter one.
class RandomValues {
 public:
  explicit RandomValues(std::function<double()> next) : next_(std::move(next)) {}

  bool none() const { return !next_; }
  std::span<const double> first(std::size_t count);

 private:
  std::function<double()> next_;
  ScalarField values_;  // so far
};
// At points drawn uniformly, with replacement, from all but the first; none from a single point. Keeps a
// reference to the map.
RandomValues values_at_random_points(std::span<const double> map, Rng rng);
// Quantiles of uniform numbers: independent of the numbering of the points. `sorted` ascends.
RandomValues random_quantiles(std::vector<double> sorted, Rng rng);

struct Splits {
  std::int32_t count;       // draws that the area is averaged over
  std::int32_t thresholds;  // number of even thresholds
};

// Every tenth of the range of a map. [borji2013]
std::vector<double> tenths_of_range(std::span<const double> map);

// Without thresholds, those of a split are evenly spaced from 0 to the largest value among its picks and
// negatives [tasse2016]. `picks` are the values at the picked points.
double sampled_auc(std::span<const double> picks, RandomValues& negatives, const Splits& splits,
                   const std::vector<double>& thresholds = {});

}  // namespace salbench
