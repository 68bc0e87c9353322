// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

#include "stages/core/rng.h"
#include "stages/core/types.h"

namespace salbench {

// Bins hold 0..levels-1: few levels make many equal distances, and many bins that are 0 in both histograms.
inline Descriptors random_histograms(std::size_t n, std::uint64_t levels, std::uint64_t seed) {
  Rng rng(seed, "histograms", "");
  Descriptors descriptors;
  descriptors.values.resize(n * kFpfhBins);
  for (float& value : descriptors.values) value = static_cast<float>(rng.below(levels));
  return descriptors;
}

}  // namespace salbench
