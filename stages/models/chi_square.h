// SPDX-License-Identifier: GPL-3.0-or-later
// Chi-square distance of two descriptors in double precision, not halved:
// sum (a - b)^2 / (a + b), bins where both are 0 adding nothing; values >= 0.
#pragma once

#include <cstdint>
#include <span>

#include "stages/core/types.h"

namespace salbench {

double chi_square(std::span<const float, kFpfhBins> a, std::span<const float, kFpfhBins> b);

// result[i] is the distance of `a` from row rows[i] of the descriptors, to the bit that of chi_square();
// sizes of `rows` and `result` agree. Several rows are looked at side by side.
void chi_squares(std::span<const float, kFpfhBins> a, const Descriptors& descriptors,
                 std::span<const std::int32_t> rows, std::span<double> result);

}  // namespace salbench
