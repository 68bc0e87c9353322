// SPDX-License-Identifier: GPL-3.0-or-later
// Areas under the ROC curve whose negatives are random draws, as many as there are picks, averaged over
// splits. The curve runs from (1, 1) over the rates of values >= each threshold to (0, 0). `picks` are
// the values at the picked points; without any the area is NaN.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stages/metrics/distribution.h"
#include "stages/metrics/draws.h"

namespace salbench {

struct Splits {
  std::int32_t count;       // draws that the area is averaged over
  std::int32_t thresholds;  // evenly spaced from 0 to the largest value among picks and negatives

  bool operator==(const Splits&) const = default;
};

// Values of a map at points drawn uniformly, with replacement, from all but the first; and what the curves of
// several lists of picks need of them. [tasse2016]
class ValueDraws {
 public:
  // At least two points, before the first draw. Both outlive it.
  ValueDraws(std::span<const double> map, Draws& draws) : map_(map), draws_(draws) {}

  bool any_negative();
  // Of all points but the first. Valid until the next call.
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

// Negatives are the values that are drawn. [tasse2016]
double sampled_auc(std::span<const double> picks, ValueDraws& draws, const Splits& splits);

enum class Thresholds : std::uint8_t {
  even,   // from 0 to the largest value among picks and negatives [tasse2016]
  tenths  // at every tenth of the map's range [borji2013]
};

struct QuantileCurve {
  const Distribution& map;
  Thresholds thresholds;
};

// [curve]. Each negative is the quantile of a uniform number in the distribution of the curve's map: so the
// draws depend neither on the numbering of the points nor, by area, on how the surface is divided into faces.
// The curves share the draws, which are counted once for all; no area depends on the other curves. NaN for a
// distribution over nothing.
std::vector<double> quantile_aucs(std::span<const QuantileCurve> curves, std::span<const double> picks,
                                  Draws& draws, const Splits& splits);

}  // namespace salbench
