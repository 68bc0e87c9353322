// SPDX-License-Identifier: GPL-3.0-or-later
// CB, centre bias: the control that knows where a point lies, and nothing else. In pictures people look at
// the centre; of a shape they mark what is far from it.
#pragma once

#include "stages/core/options.h"
#include "stages/core/types.h"

namespace salbench {

using CbOptions = NoOptions;

// Distance from the centroid, the mean of the points, in R: in [0, 1]. Does not depend on place, orientation
// and size of the shape. Throws InputError for a shape without points or extent, and for a coordinate that
// is not finite, or whose square overflows. [tatler2007]
ScalarField cb_saliency(Points points, const CbOptions& options);

}  // namespace salbench
