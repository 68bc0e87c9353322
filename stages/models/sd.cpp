// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/sd.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stages/core/mesh_ops.h"
#include "stages/core/neighbours.h"
#include "stages/core/parallel.h"

namespace salbench {
namespace {

// 0 where the density has no number: of an area that is 0, or nearly.
double one_over(double area) { return std::isnormal(area) ? 1 / area : 0; }

}  // namespace

ScalarField sd_saliency(Points points, Surface surface, const SdOptions& options) {
  check(options);
  check_faces(points.size(), surface);
  ScalarField density = barycentric_areas(in_units_of_radius(points), surface);
  std::ranges::transform(density, density.begin(), one_over);
  return density;
}

ScalarField sd_saliency_of_points(Points points, const SdOptions& options) {
  check(options);
  const std::vector<Vec3> placed = in_units_of_radius(points);
  const KdTree tree(placed);
  const std::size_t others = std::min(index(options.neighbours), placed.size() - 1);
  ScalarField density(placed.size());
  parallel_ranges(placed.size(), kPointGrain, [&](std::size_t first, std::size_t last) {
    std::vector<Neighbour> nearest;
    for (std::size_t i = first; i < last; ++i) {
      tree.nearest(placed[i], others + 1, nearest);  // the point is among them
      density[i] = static_cast<double>(others) * one_over(std::numbers::pi * nearest.back().distance_squared);
    }
  });
  const double densest = std::ranges::max(density);
  std::ranges::replace(density, 0.0, densest);
  return density;
}

}  // namespace salbench
