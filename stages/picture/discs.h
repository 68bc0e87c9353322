// SPDX-License-Identifier: GPL-3.0-or-later
// A scan as discs, one per point, that cover what its scanner saw and leave no gaps.
#pragma once

#include <vector>

#include "stages/core/types.h"
#include "stages/picture/camera.h"
#include "stages/picture/raster.h"

namespace salbench {

// In eye space, in the order of the points. The scanner's step is found from the distances between the
// points.
std::vector<Disc> discs_of(const Scan& scan, const Normals& normals, const Camera& camera);

}  // namespace salbench
