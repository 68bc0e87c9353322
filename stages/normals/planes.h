// SPDX-License-Identifier: GPL-3.0-or-later
// Normals without orientation: the directions across which the neighbourhoods are thinnest.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "stages/core/types.h"
#include "stages/geometry/neighbours.h"

namespace salbench {

// The direction preferred for the normal of a point whose neighbourhood spans no plane; any length but 0.
using PreferredDirection = std::function<Vec3(std::size_t point)>;

// The normal of the least-squares plane through the `neighbours` points nearest to each point, itself
// included; its sign is arbitrary. If the neighbourhood lies on one line, the normal is the preferred
// direction made perpendicular to the line; if it coincides in one place, the preferred direction itself.
// `tree` is over `points`; neighbours >= 1. The same search fills `kept`, if there is one, with as many as it
// holds of each point.
Normals plane_normals(std::span<const Vec3> points, const KdTree& tree, std::int32_t neighbours,
                      const PreferredDirection& preferred, NearestPoints* kept = nullptr);

}  // namespace salbench
