// SPDX-License-Identifier: GPL-3.0-or-later
// Correlation of paired samples of one length. Pairs with a NaN are left out; the result is NaN if a sample
// is constant or fewer than two pairs remain.
#pragma once

#include <span>

namespace salbench {

double pearson(std::span<const double> x, std::span<const double> y);   // linear; in [-1, 1]
double spearman(std::span<const double> x, std::span<const double> y);  // of the mid-ranks

}  // namespace salbench
