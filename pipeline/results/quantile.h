// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

namespace salbench {

// The value below which a fraction q of the values that are not NaN lies, 0 <= q <= 1, linear between the
// values at q (n - 1); NaN if there is none. [hyndman1996, definition 7]
double quantile(std::span<const double> values, double q);
double median(std::span<const double> values);

}  // namespace salbench
