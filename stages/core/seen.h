// SPDX-License-Identifier: GPL-3.0-or-later
// Ground truth with a mask: the saliency of an invisible point is NaN, and the point is excluded from all
// measures.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

// Indices of the visible points, ascending; nullopt if all are visible.
std::optional<std::vector<std::int32_t>> seen_points(std::span<const double> saliency);

// Ground truth of these points only, indexed by position in the list. Picks of other points and all viewers
// are dropped.
GroundTruth truth_at(const GroundTruth& truth, std::span<const std::int32_t> points);

// Mean of some of m maps of a shape at each point, over the maps in which it is visible; NaN if it is in
// none. `maps`: m x n; `members`: their indices, at least one. Independent of their order.
ScalarField mean_of_seen(std::span<const ScalarField> maps, std::span<const std::size_t> members);

}  // namespace salbench
