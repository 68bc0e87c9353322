// SPDX-License-Identifier: GPL-3.0-or-later
// Distance of distributions.
#pragma once

#include "stages/core/types.h"

namespace salbench {

// Kolmogorov-Smirnov distance at the bin edges: the largest difference of the normalised cumulative sums, in
// [0, 1]. NaN if a histogram is empty. Densities and counts give the same result.
double kolmogorov_smirnov(const Histogram& a, const Histogram& b);

}  // namespace salbench
