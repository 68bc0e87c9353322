// SPDX-License-Identifier: GPL-3.0-or-later
// Histogram matching gives the maps of all models the value distribution of the human ground truth, so that
// metrics compare where a map is high, not how its values are distributed. [tasse2016]
#pragma once

#include <span>

#include "stages/core/types.h"

namespace salbench {

// Density histogram over [0, 1] of the min-max-normalised field (n > 0, NaN counts as 0). A constant field
// falls into the middle bin, as in NumPy. [tasse2016]
Histogram normalised_histogram(std::span<const double> field);

// Mean of each bin; all 0 if there are no histograms.
Histogram mean_histogram(std::span<const Histogram> histograms);

// Transforms the values of a map so that their distribution equals that of `reference` (densities over [0,
// 1]) bin by bin, then min-max-normalises. Monotone: keeps the order of the points. NaN counts as 0. A
// constant map is unchanged. [tasse2016]
ScalarField matched(std::span<const double> map, const Histogram& reference);

}  // namespace salbench
