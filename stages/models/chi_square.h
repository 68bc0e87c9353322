// SPDX-License-Identifier: GPL-3.0-or-later
// Chi-square distance of two descriptors in double precision, not halved:
// sum (a - b)^2 / (a + b), bins where both are 0 adding nothing; values >= 0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

double chi_square(std::span<const float, kFpfhBins> a, std::span<const float, kFpfhBins> b);

// Bins that are nonzero in some descriptor, ascending.
std::vector<std::size_t> used_bins(const Descriptors& descriptors);

// Distances of successive descriptors from the same rows of others. Rows are stored bin by bin and processed
// in parallel lanes; distances equal those of chi_square() to the bit.
class ChiSquares {
 public:
  // All compared descriptors are 0 except in these bins.
  explicit ChiSquares(std::vector<std::size_t> bins) : bins_(std::move(bins)) {}

  void set_rows(const Descriptors& descriptors, std::span<const std::int32_t> rows);
  // result[i] is the distance from the i-th row that was set.
  void measure(std::span<const float, kFpfhBins> from, std::span<double> result) const;

 private:
  std::vector<std::size_t> bins_;
  std::vector<float> blocks_;  // rows; within a block bin by bin
  std::size_t count_ = 0;      // number of rows
};

}  // namespace salbench
