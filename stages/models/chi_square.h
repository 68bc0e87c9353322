// SPDX-License-Identifier: GPL-3.0-or-later
// Chi-square distance of two descriptors in double precision, not halved:
// sum (a - b)^2 / (a + b), bins where both are 0 adding nothing; values >= 0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

double chi_square(std::span<const float, kFpfhBins> a, std::span<const float, kFpfhBins> b);

// The bins that are not 0 in every descriptor, ascending.
std::vector<std::size_t> used_bins(const Descriptors& descriptors);

// result[i] is the distance of `a` from row rows[i] of the descriptors over the given bins, the others being
// 0 in both: to the bit that of chi_square(). Several rows are looked at side by side. Sizes of `rows` and
// `result` agree.
void chi_squares(std::span<const float, kFpfhBins> a, const Descriptors& descriptors,
                 std::span<const std::int32_t> rows, std::span<const std::size_t> bins,
                 std::span<double> result);

}  // namespace salbench
