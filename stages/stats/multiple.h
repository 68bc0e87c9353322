// SPDX-License-Identifier: GPL-3.0-or-later
// Many tests at once.
#pragma once

#include <span>
#include <vector>

namespace salbench {

// Holm's step-down adjustment. Rejecting each hypothesis whose adjusted value is at most the level keeps the
// probability of any false rejection at most the level. NaN stays NaN and does not count as a test.
// [holm1979]
std::vector<double> holm_adjusted(std::span<const double> p_values);

}  // namespace salbench
