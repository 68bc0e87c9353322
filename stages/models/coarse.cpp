// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/coarse.h"

#include <utility>

#include "stages/models/interpolated.h"
#include "stages/models/simplified.h"

namespace salbench {

CoarseSurface::CoarseSurface(std::vector<Vec3> points, Surface surface, std::size_t most_faces)
    : full_{std::move(points), {surface.begin(), surface.end()}} {
  if (full_.faces.size() <= most_faces) return;
  coarse_ = simplified(full_, most_faces);
  is_coarse_ = !coarse_.vertices.empty();  // empty if no face has an area
}

ScalarField CoarseSurface::on_all_points(ScalarField values) const {
  if (!is_coarse_) return values;
  return interpolated(full_.vertices, KdTree(coarse_.vertices), values);
}

}  // namespace salbench
