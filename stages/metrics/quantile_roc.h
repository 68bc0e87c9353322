// SPDX-License-Identifier: GPL-3.0-or-later
// Areas under ROC curves whose negatives are quantiles of a map's distribution, averaged over splits. `picks`
// are the values at the picked points; without any the area is NaN.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stages/metrics/distribution.h"
#include "stages/metrics/draws.h"
#include "stages/metrics/split_curve.h"

namespace salbench {

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
