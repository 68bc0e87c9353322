// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/rng.h"
#include "stages/core/types.h"
#include "stages/models/chi2_search.h"

namespace salbench {

// Bins contain 0..levels-1: few levels give many equal distances, and many bins that are 0 in both
// histograms.
inline Descriptors random_histograms(std::size_t n, std::uint64_t levels, std::uint64_t seed) {
  Rng rng(seed, "histograms", "");
  Descriptors descriptors;
  descriptors.values.resize(n * kFpfhBins);
  for (float& value : descriptors.values) value = static_cast<float>(rng.below(levels));
  return descriptors;
}

// By the formula, in single precision as in the search, so that the order of distances agrees.
inline float chi2_by_formula(std::span<const float, kFpfhBins> a, std::span<const float, kFpfhBins> b) {
  float sum = 0;
  for (std::size_t bin = 0; bin < kFpfhBins; ++bin)
    if (a[bin] + b[bin] > 0) sum += (a[bin] - b[bin]) * (a[bin] - b[bin]) / (a[bin] + b[bin]);
  return sum;
}

// Calls visit(i, nearest) once for each histogram i; `nearest` are the k closest references, unordered.
template <class Visit>
void for_each_nearest(const Chi2Search& search, std::size_t k, const Visit& visit) {
  Chi2Finder finder(search, k);
  for (std::size_t q = 0; q < search.queries().size(); ++q) {
    const Chi2Nearest nearest = finder.find(search.row(q));
    std::vector<Chi2Neighbour> all(nearest.others.begin(), nearest.others.end());
    for (std::size_t at = 0; at < nearest.groups.size() * chi2_kernel::kLanes; ++at) {
      const auto group = index(nearest.groups[at / chi2_kernel::kLanes]);
      if (nearest.distances[at] <= nearest.sure)
        all.push_back({search.table().order[group * chi2_kernel::kLanes + at % chi2_kernel::kLanes],
                       nearest.distances[at]});
    }
    visit(index(search.queries()[q]), std::span<const Chi2Neighbour>(all));
  }
}

}  // namespace salbench
