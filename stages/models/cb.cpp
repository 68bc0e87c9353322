// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/cb.h"

#include <algorithm>

#include "stages/core/mesh_ops.h"

namespace salbench {

ScalarField cb_saliency(Points points, const CbOptions&) {
  ScalarField distance;
  distance.reserve(points.size());
  for (const Vec3& p : in_units_of_radius(points)) distance.push_back(std::min(p.norm(), 1.0));
  return distance;
}

}  // namespace salbench
