// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/cb.h"

#include "stages/core/centre.h"

namespace salbench {

ScalarField cb_saliency(Points points, const CbOptions&) { return distances_from_centroid(points); }

}  // namespace salbench
