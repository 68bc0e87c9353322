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

// The bins that are not 0 in every descriptor, ascending.
std::vector<std::size_t> used_bins(const Descriptors& descriptors);

// Distances of one descriptor after the other from the same rows of others. The rows lie bin by bin, so that
// several are looked at side by side; to the bit the distances are those of chi_square().
class ChiSquares {
 public:
  // All descriptors that are compared are 0 but for these bins.
  explicit ChiSquares(std::vector<std::size_t> bins) : bins_(std::move(bins)) {}

  void set_rows(const Descriptors& descriptors, std::span<const std::int32_t> rows);
  // result[i] is the distance from the i-th row that was set.
  void measure(std::span<const float, kFpfhBins> from, std::span<double> result) const;

 private:
  std::vector<std::size_t> bins_;
  std::vector<float> blocks_;  // of rows; in a block bin by bin
  std::size_t count_ = 0;      // of rows
};

}  // namespace salbench
