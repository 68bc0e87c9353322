// SPDX-License-Identifier: GPL-3.0-or-later
// Points as discs, one each, that leave no gaps.
#pragma once

#include <vector>

#include "stages/core/types.h"
#include "stages/picture/camera.h"
#include "stages/picture/raster.h"

namespace salbench {

// In eye space, in the order of the points. The scanner's step is found from the distances between the
// points.
std::vector<Disc> discs_of(const Scan& scan, const Normals& normals, const Camera& camera);

// The same of points whose density follows no scanner: round discs in the planes of the points, each as large
// as the points around it are far apart, which cover what is seen.
std::vector<Disc> discs_of(Points points, const Normals& normals, const Camera& camera);

}  // namespace salbench
