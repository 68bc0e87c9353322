// SPDX-License-Identifier: GPL-3.0-or-later
// Areas under ROC curves whose negatives are drawn at random, averaged over splits: in each of them as many
// as there are picks. A curve runs from (1, 1) over the rates of values >= each threshold to (0, 0). All are
// NaN without picks. `picks` are the values at the picked points.
#pragma once

#include <cstdint>
#include <span>

#include "stages/core/rng.h"
#include "stages/metrics/distribution.h"

namespace salbench {

struct Splits {
  std::int32_t count;       // draws that the area is averaged over
  std::int32_t thresholds;  // of even ones
};

enum class Thresholds : std::uint8_t {
  even,   // from 0 to the largest value among picks and negatives [tasse2016]
  tenths  // at every tenth of the map's range [borji2013]
};

// Negatives are values at points drawn uniformly, with replacement, from all but the first; thresholds are
// even. NaN for a single point.
double sampled_auc(std::span<const double> map, std::span<const double> picks, const Splits& splits, Rng rng);

// Negatives are quantiles of uniform numbers in the map's distribution: so the draws depend neither on the
// numbering of the points nor, by area, on how the surface is divided into faces. NaN for a distribution over
// nothing.
double quantile_auc(const Distribution& map, std::span<const double> picks, Thresholds thresholds,
                    const Splits& splits, Rng rng);

}  // namespace salbench
