// SPDX-License-Identifier: GPL-3.0-or-later
// Ground truth with a mask: a point that nobody could see has NaN as its saliency, and takes no part in
// anything that is measured.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

// Indices of the points that were seen, ascending; nothing if all of them were.
std::optional<std::vector<std::int32_t>> seen_points(std::span<const double> saliency);

// The ground truth of these points alone, by their place in the list. Picks of other points are left out, and
// viewers too.
GroundTruth truth_at(const GroundTruth& truth, std::span<const std::int32_t> points);

// The mean of some of m maps of one shape at each point, over those that have it seen; NaN where none has.
// `maps`: m x n; `members`: which of them, at least one. Does not depend on their order.
ScalarField mean_of_seen(std::span<const ScalarField> maps, std::span<const std::size_t> members);

}  // namespace salbench
