// SPDX-License-Identifier: GPL-3.0-or-later
// CB, centre bias: the control that knows where a point lies, and nothing else.
#pragma once

#include "stages/core/options.h"
#include "stages/core/types.h"

namespace salbench {

using CbOptions = NoOptions;

// distances_from_centroid() of stages/core/centre.h.
ScalarField cb_saliency(Points points, const CbOptions& options);

}  // namespace salbench
