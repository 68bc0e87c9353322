// SPDX-License-Identifier: GPL-3.0-or-later
// Histogram matching gives the maps of all models the distribution of values of the human ground truth, so
// that metrics compare where a map is high and not how its values happen to be spread. [tasse2016]
#pragma once

#include <span>

#include "stages/core/types.h"

namespace salbench {

// Density histogram over [0, 1] of the min-max-normalised field (n > 0, NaN counts as 0). A constant field
// falls into the middle bin, as in NumPy. [tasse2016]
Histogram normalised_histogram(std::span<const double> field);

// The mean of each bin; all 0 if there are no histograms.
Histogram mean_histogram(std::span<const Histogram> histograms);

// The map with its values moved so that their distribution is, bin by bin, that of `reference` (densities
// over [0, 1]), then min-max-normalised. Monotone: the order of the points stays. NaN counts as 0. A constant
// map stays as it is. [tasse2016]
ScalarField matched(std::span<const double> map, const Histogram& reference);

}  // namespace salbench
