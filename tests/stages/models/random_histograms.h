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

// Bins hold 0..levels-1: few levels make many equal distances, and many bins that are 0 in both histograms.
inline Descriptors random_histograms(std::size_t n, std::uint64_t levels, std::uint64_t seed) {
  Rng rng(seed, "histograms", "");
  Descriptors descriptors;
  descriptors.values.resize(n * kFpfhBins);
  for (float& value : descriptors.values) value = static_cast<float>(rng.below(levels));
  return descriptors;
}

// Calls visit(i, nearest) once for each histogram i; `nearest` holds the k references of smallest distance to
// it, in no order.
template <class Visit>
void for_each_nearest(const Chi2Search& search, std::size_t k, const Visit& visit) {
  Chi2Nearest nearest = search.nearest(k);
  for (std::size_t q = 0; q < search.queries().size(); ++q) {
    nearest.start(search.row(q));
    nearest.find();
    std::vector<Chi2Neighbour> found = nearest.others();
    nearest.look().append_between(-1, nearest.sure(), found);
    visit(static_cast<std::size_t>(search.queries()[q]), std::span<const Chi2Neighbour>(found));
  }
}

}  // namespace salbench
