// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/nv.h"

#include "stages/core/check.h"
#include "stages/core/mesh_ops.h"
#include "stages/core/neighbours.h"
#include "stages/core/parallel.h"
#include "stages/core/support.h"

namespace salbench {

ScalarField nv_saliency(Points points, const Normals& normals, const NvOptions& options) {
  check(options);
  CHECK_EQ(normals.size(), points.size());
  const std::vector<Vec3> placed = in_units_of_radius(points);
  const KdTree tree(placed);
  const double radius = grown_support_radius(placed, tree, options.radius).radius;
  ScalarField variation(points.size(), 0);
  parallel_ranges(points.size(), kPointGrain, [&](std::size_t first, std::size_t last) {
    std::vector<Neighbour> around;
    for (std::size_t i = first; i < last; ++i) {
      tree.within(placed[i], radius, around);  // in order: the sum is the same however the shape is turned
      double sum = 0;
      for (const Neighbour& n : around) sum += (normals[i] - normals[index(n.index)]).squaredNorm();
      // The point is among its neighbours, and adds 0.
      if (around.size() > 1) variation[i] = sum / (2 * static_cast<double>(around.size() - 1));
    }
  });
  return variation;
}

}  // namespace salbench
