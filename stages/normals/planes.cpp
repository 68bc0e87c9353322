// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/normals/planes.h"

#include <vector>

#include <Eigen/Eigenvalues>

namespace salbench {
namespace {

// A squared spread below this fraction of the largest is the solver's rounding: the points are on a line.
constexpr double kNoSpread = 1e-14;

Vec3 perpendicular(const Vec3& preferred, const Vec3& line) {
  const Vec3 across = preferred - preferred.dot(line) * line;
  // If the preferred direction runs along the line, any fixed perpendicular will do.
  return across.norm() > 1e-9 * preferred.norm() ? across.normalized() : line.unitOrthogonal();
}

}  // namespace

Normals plane_normals(std::span<const Vec3> points, const KdTree& tree, std::int32_t neighbours,
                      const PreferredDirection& preferred) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  std::vector<Neighbour> near;
  Normals normals(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    tree.nearest(points[i], static_cast<std::size_t>(neighbours), near);
    // Coordinates are relative to the point itself: far from the origin, sums of squares would lose the
    // shape.
    Vec3 mean = Vec3::Zero();
    for (const Neighbour& n : near) mean += points[static_cast<std::size_t>(n.index)] - points[i];
    mean /= static_cast<double>(near.size());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Neighbour& n : near) {
      const Vec3 p = points[static_cast<std::size_t>(n.index)] - points[i] - mean;
      covariance += p * p.transpose();
    }
    solver.compute(covariance);
    const Vec3& spread = solver.eigenvalues();  // ascending
    if (!(spread[2] > 0))
      normals[i] = preferred(i).normalized();
    else if (spread[1] <= kNoSpread * spread[2])
      normals[i] = perpendicular(preferred(i), solver.eigenvectors().col(2));
    else
      normals[i] = solver.eigenvectors().col(0).normalized();
  }
  return normals;
}

}  // namespace salbench
