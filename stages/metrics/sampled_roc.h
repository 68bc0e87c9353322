// SPDX-License-Identifier: GPL-3.0-or-later
// Areas under ROC curves whose negatives are values of points drawn at random, averaged over splits. `picks`
// are the values at the picked points; without any the area is NaN. [tasse2016]
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stages/metrics/draws.h"
#include "stages/metrics/split_curve.h"

namespace salbench {

// Values of a map at points drawn uniformly, with replacement, from all but the first; and what the curves of
// several lists of picks need of them.
class ValueDraws {
 public:
  // At least two points, before the first draw. Both outlive it.
  ValueDraws(std::span<const double> map, Draws& draws) : map_(map), draws_(draws) {}

  bool any_negative();
  // Points drawn, numbered without the first one. Valid until the next call.
  std::span<const std::uint32_t> points(std::size_t count);
  double value(std::uint32_t point) const { return map_[point + 1]; }
  // [point]: how many of so many even thresholds up to `largest` > 0 it reaches, one more if it lies above.
  // Without negative values. Valid until the next call.
  std::span<const std::uint16_t> reached(std::int32_t thresholds, double largest);

 private:
  std::span<const double> map_;
  Draws& draws_;
  std::optional<bool> any_negative_;
  std::int32_t thresholds_ = 0;  // of reached_
  double largest_ = 0;
  std::vector<std::uint16_t> reached_;
};

double sampled_auc(std::span<const double> picks, ValueDraws& draws, const Splits& splits);

}  // namespace salbench
