// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <numeric>

#include "stages/geometry/mesh_ops.h"

namespace salbench {

// Integral of a density over the surface.
inline double integral(const Mesh& mesh, const ScalarField& density) {
  const ScalarField areas = barycentric_areas(mesh.vertices, mesh.faces);
  return std::inner_product(areas.begin(), areas.end(), density.begin(), 0.0);
}

}  // namespace salbench
