// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/vd.h"

#include "stages/core/mesh_ops.h"

namespace salbench {

ScalarField vd_saliency(Points points, Surface surface, const VdOptions&) {
  check_faces(points.size(), surface);
  const Adjacency adjacency = edge_adjacency(points.size(), surface);
  ScalarField degree(points.size());
  for (std::size_t i = 0; i < degree.size(); ++i) degree[i] = static_cast<double>(adjacency.of(i).size());
  return degree;
}

}  // namespace salbench
