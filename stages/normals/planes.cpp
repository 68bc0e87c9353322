// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/normals/planes.h"

#include <algorithm>
#include <vector>

#include <Eigen/Eigenvalues>

#include "stages/core/parallel.h"

namespace salbench {
namespace {

// A squared spread below this fraction of the largest is the solver's rounding: the points are on a line.
constexpr double kNoSpread = 1e-14;

Vec3 perpendicular(const Vec3& preferred, const Vec3& line) {
  const Vec3 across = preferred - preferred.dot(line) * line;
  // If the preferred direction runs along the line, any fixed perpendicular will do.
  return across.norm() > 1e-9 * preferred.norm() ? across.normalized() : line.unitOrthogonal();
}

// Coordinates are relative to the point itself: far from the origin, sums of squares would lose the shape.
Eigen::Matrix3d covariance_around(std::size_t point, std::span<const Vec3> points,
                                  std::span<const Neighbour> near) {
  Vec3 mean = Vec3::Zero();
  for (const Neighbour& n : near) mean += points[static_cast<std::size_t>(n.index)] - points[point];
  mean /= static_cast<double>(near.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Neighbour& n : near) {
    const Vec3 p = points[static_cast<std::size_t>(n.index)] - points[point] - mean;
    covariance += p * p.transpose();
  }
  return covariance;
}

}  // namespace

Normals plane_normals(std::span<const Vec3> points, const KdTree& tree, std::int32_t neighbours,
                      const PreferredDirection& preferred, NearestPoints* kept) {
  const std::size_t of_plane = std::min(static_cast<std::size_t>(neighbours), points.size());
  const std::size_t of_kept = kept == nullptr ? 0 : kept->each();
  Normals normals(points.size());
  parallel_ranges(points.size(), kPointGrain, [&](std::size_t first, std::size_t last) {
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    std::vector<Neighbour> near;
    for (std::size_t i = first; i < last; ++i) {
      tree.nearest(points[i], std::max(of_plane, of_kept), near);
      if (kept != nullptr) std::copy_n(near.begin(), of_kept, kept->of(i).begin());
      solver.compute(covariance_around(i, points, std::span(near).first(of_plane)));
      const Vec3& spread = solver.eigenvalues();  // ascending
      if (!(spread[2] > 0))
        normals[i] = preferred(i).normalized();
      else if (spread[1] <= kNoSpread * spread[2])
        normals[i] = perpendicular(preferred(i), solver.eigenvectors().col(2));
      else
        normals[i] = solver.eigenvectors().col(0).normalized();
    }
  });
  return normals;
}

}  // namespace salbench
