// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/centre.h"

#include <algorithm>

#include "stages/core/mesh_ops.h"

namespace salbench {

ScalarField distances_from_centroid(Points points) {
  ScalarField distances;
  distances.reserve(points.size());
  for (const Vec3& p : in_units_of_radius(points)) distances.push_back(std::min(p.norm(), 1.0));
  return distances;
}

}  // namespace salbench
