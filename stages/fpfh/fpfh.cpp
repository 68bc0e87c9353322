// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/fpfh/fpfh.h"

#include <cmath>

#include "stages/core/errors.h"
#include "stages/core/mesh_ops.h"

namespace salbench {
namespace {

Support support_of(std::span<const Vec3> points, const KdTree& tree, const FpfhOptions& options) {
  if (options.neighbourhood == FpfhNeighbourhood::nearest) return {options.neighbours, 0};
  if (options.grow)
    return {0, grown_support_radius(points, tree, options.radius, options.grown_neighbours).radius};
  const double radius = options.radius * bounding_radius(points);
  require_few_neighbours(points, tree, radius);
  return {0, radius};
}

}  // namespace

Descriptors fpfh(std::span<const Vec3> points, std::span<const Vec3> normals, const FpfhOptions& options) {
  check(options);
  if (points.empty()) throw ShapeError("the shape has no points");
  if (!centroid(points).allFinite() || !std::isfinite(bounding_radius(points)))
    throw ShapeError("the shape has a coordinate that is not finite, or whose square overflows");
  const KdTree tree(points);
  return fpfh(points, normals, tree, support_of(points, tree, options), options.weighting);
}

}  // namespace salbench
