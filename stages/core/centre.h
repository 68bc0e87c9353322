// SPDX-License-Identifier: GPL-3.0-or-later
// Centre bias of a shape. In pictures people look at the centre; of a shape they mark what is far from it.
#pragma once

#include "stages/core/types.h"

namespace salbench {

// Distance from the centroid, the mean of the points, in R: n values in [0, 1]. Does not depend on place,
// orientation and size of the shape. Throws InputError for a shape without points or extent, and for a
// coordinate that is not finite, or whose square overflows. [tatler2007]
ScalarField distances_from_centroid(Points points);

}  // namespace salbench
