// SPDX-License-Identifier: GPL-3.0-or-later
// Sums of chi-square distances, weighted by the distance in space, over the nearest histograms of each.
#pragma once

#include <cstddef>
#include <vector>

#include "stages/core/types.h"
#include "stages/models/chi2_search.h"

namespace salbench {

// Sums chi2 * weight(d) over the k nearest references of each histogram, d the distance between their points;
// 0 where the k nearest differ by no more than 1e-9 of the largest distance. Terms are rounded, by some 2^-37
// of the largest distance, so that sums are exact: how the nearest were found does not show in them.
//   points  one per histogram, no two farther apart than 2; read in single precision
//   kth     per histogram, where its k-th nearest is thought to be, 0 if nothing is known, or empty;
//           afterwards where it is, or a little farther
std::vector<double> weighted_sums(const Chi2Search& search, std::size_t k, Points points,
                                  chi2_kernel::Weight weight, std::vector<float>& kth);

}  // namespace salbench
