// SPDX-License-Identifier: GPL-3.0-or-later
// Visibility of the points of a shape from one place, for ground truth whose authors did not publish it.
#pragma once

#include <vector>

#include "stages/core/types.h"

namespace salbench {

struct Viewpoint {
  Vec3 place = Vec3::Zero();  // in the coordinates of the shape
  bool at_infinity = false;   // `place` is the direction towards it, of any length
};

// n: true for each point from which a ray to the viewpoint meets no face beyond 1e-4 R of its beginning.
// Faces hide from both sides, and the side that a point shows does not matter: a point on the far side of a
// closed surface is hidden by its near side, one of an open sheet is seen from both. Without faces nothing is
// hidden. Coordinates are rounded to float, so that a point whose faces are edge-on may count as either.
// Throws InputError as in_units_of_radius does, and for a face whose point does not exist.
std::vector<bool> visible_points(Points points, Surface surface, const Viewpoint& from);

}  // namespace salbench
