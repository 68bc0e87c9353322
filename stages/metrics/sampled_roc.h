// SPDX-License-Identifier: GPL-3.0-or-later
// Areas under ROC curves whose negatives are drawn at random, averaged over splits: in each of them as many
// as there are picks. A curve runs from (1, 1) over the rates of values >= each threshold to (0, 0).
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "stages/core/rng.h"
#include "stages/metrics/distribution.h"

namespace salbench {

struct Splits {
  std::int32_t count;       // draws that the area is averaged over
  std::int32_t thresholds;  // of even ones
};

// Values of a map, drawn at random: a longer sequence begins with a shorter one. The map outlives it.
class RandomValues {
 public:
  // At points drawn uniformly, with replacement, from all but the first; none of a single point.
  RandomValues(std::span<const double> map, Rng rng);
  // Quantiles of uniform numbers: so the draws depend neither on the numbering of the points nor, by area, on
  // how the surface is divided into faces. None of a distribution over nothing.
  RandomValues(const Distribution& map, Rng rng);

  bool none() const { return next_ == nullptr; }
  std::span<const double> first(std::size_t count);

 private:
  std::function<double()> next_;
  ScalarField values_;  // so far
};

// Every tenth of the map's range. [borji2013]
std::vector<double> tenths_of_range(const Distribution& map);

// Without thresholds, those of a split are even, from 0 to the largest value among its picks and negatives
// [tasse2016]. `picks` are the values at the picked points. NaN without picks, and without negatives.
double sampled_auc(std::span<const double> picks, RandomValues& negatives, const Splits& splits,
                   const std::vector<double>& thresholds = {});

}  // namespace salbench
