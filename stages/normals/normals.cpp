// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/normals/normals.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <span>
#include <vector>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/core/parallel.h"
#include "stages/core/types.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/geometry/neighbours.h"
#include "stages/geometry/support.h"
#include "stages/normals/orient.h"

namespace salbench {
namespace {

// Zero for a vertex without faces, and if the area vectors of its faces cancel.
Normals area_weighted_normals(const Mesh& mesh) {
  Normals sums = summed_area_vectors(mesh);
  std::vector<double> areas(mesh.vertices.size(), 0);
  for (const Triangle& face : mesh.faces)
    for (const std::int32_t v : face) areas[index(v)] += face_area_vector(mesh, face).norm();
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double length = sums[i].norm();
    sums[i] = length > 1e-12 * areas[i] ? Vec3(sums[i] / length) : Vec3::Zero();  // less is rounding
  }
  return sums;
}

std::int32_t plane_neighbours(const std::vector<Vec3>& points, const KdTree& tree,
                              const MeshNormalsOptions& options) {
  if (options.neighbours > 0) return options.neighbours;
  const std::int32_t others = grown_support_radius(points, tree, options.support).neighbours;
  return std::min(others, options.most_neighbours);
}

// --- normals without orientation: directions in which the neighbourhoods are thinnest

// Squared spreads below this fraction of the largest are the solver's rounding errors: the points are
// collinear.
constexpr double kNoSpread = 1e-14;

Vec3 perpendicular(const Vec3& preferred, const Vec3& line) {
  const Vec3 across = preferred - preferred.dot(line) * line;
  // If the preferred direction is along the line, uses any fixed perpendicular.
  return across.norm() > 1e-9 * preferred.norm() ? across.normalized() : line.unitOrthogonal();
}

// Coordinates are relative to the point itself: far from the origin, sums of squares would lose precision.
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

// Preferred direction of the normal where a neighbourhood spans no plane; any nonzero length.
using PreferredDirection = std::function<Vec3(std::size_t point)>;

// Normal of the least-squares plane through the `neighbours` points nearest to each point, including itself;
// its sign is arbitrary. If the neighbourhood is collinear, the normal is the preferred direction made
// perpendicular to the line; if it coincides, the preferred direction itself. `tree` is over `points`;
// neighbours >= 1. The same search fills `kept`, if given, with as many neighbours as it has room for.
Normals plane_normals(std::span<const Vec3> points, const KdTree& tree, std::int32_t neighbours,
                      const PreferredDirection& preferred, NearestPoints* kept = nullptr) {
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

// --- orientation

// The six outermost points along the axes are on the hull, so their outward direction is known. Chooses the
// one that faces its axis most: where the surface is parallel to the axis, noise would decide.
OrientationSeed outermost(std::span<const Vec3> points, const Normals& normals,
                          std::span<const std::int32_t> component) {
  OrientationSeed best{component.front(), Vec3::UnitX()};
  double best_facing = -1;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      const std::int32_t extreme = *std::ranges::max_element(component, [&](std::int32_t i, std::int32_t j) {
        return sign * at(points, i)[axis] < sign * at(points, j)[axis];
      });
      const double facing = std::abs(at(normals, extreme)[axis]);
      if (facing <= best_facing) continue;
      best_facing = facing;
      best = {extreme, sign * Vec3::Unit(axis)};
    }
  }
  return best;
}

Normals outward_normals(const std::vector<Vec3>& points, const MeshNormalsOptions& options) {
  const KdTree tree(points);
  const Vec3 centre = centroid(points);
  const auto outwards = [&](std::size_t i) -> Vec3 {
    return points[i] == centre ? Vec3::UnitZ() : Vec3(points[i] - centre);
  };
  const OrientationGraph graph{options.orientation_neighbours};
  NearestPoints near(points.size(), graph.searched(points.size()));
  Normals normals = plane_normals(points, tree, plane_neighbours(points, tree, options), outwards, &near);
  const auto seed_of = [&](std::span<const std::int32_t> part) { return outermost(points, normals, part); };
  orient_normals(points, near, graph, seed_of, normals);
  return normals;
}

}  // namespace

void check(const MeshNormalsOptions& options) {
  check_ranges(options);
  if (options.neighbours == 1 || options.neighbours == 2)
    throw OptionError{"neighbours", fmt::format("must be 0 or at least 3, not {}", options.neighbours)};
}

Normals mesh_normals(const Mesh& mesh, const MeshNormalsOptions& options) {
  require_finite(mesh.vertices);
  if (options.method == MeshNormalsMethod::pca) {
    if (mesh.vertices.empty()) throw ShapeError("the mesh has no vertices: normals cannot be computed");
    return outward_normals(mesh.vertices, options);
  }
  Normals normals = area_weighted_normals(mesh);
  if (!fill_from_nearest(mesh.vertices, normals, [](const Vec3& normal) { return !normal.isZero(0); }))
    throw ShapeError("no face has an area: normals cannot be computed");
  return normals;
}

Normals scan_normals(const Scan& scan, const ScanNormalsOptions& options) {
  const std::vector<Vec3>& points = scan.points;
  require_finite(points);
  const KdTree tree(points);
  const auto to_camera = [&](std::size_t i) -> Vec3 {
    return points[i] == scan.camera ? Vec3::UnitZ() : Vec3(scan.camera - points[i]);
  };
  if (options.orientation == ScanOrientation::camera) {
    Normals normals = plane_normals(points, tree, options.neighbours, to_camera);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (normals[i].dot(to_camera(i)) < 0) normals[i] = -normals[i];
    return normals;
  }
  const auto nearest_to_camera = [&](std::span<const std::int32_t> part) -> OrientationSeed {
    const std::int32_t nearest = *std::ranges::min_element(part, [&](std::int32_t i, std::int32_t j) {
      return (at(points, i) - scan.camera).squaredNorm() < (at(points, j) - scan.camera).squaredNorm();
    });
    return {nearest, to_camera(static_cast<std::size_t>(nearest))};
  };
  OrientationGraph graph{.neighbours = options.orientation_neighbours,
                         .largest_turn = options.max_normal_angle_degrees * std::numbers::pi / 180};
  NearestPoints near(points.size(), graph.searched(points.size()));
  Normals normals = plane_normals(points, tree, options.neighbours, to_camera, &near);
  graph.longest_edge = options.gap * median_spacing(near);
  orient_normals(points, near, graph, nearest_to_camera, normals);
  return normals;
}

Normals cloud_normals(const PointCloud& cloud, const ScanNormalsOptions& options) {
  if (!cloud.normals.empty()) return cloud.normals;
  if (cloud.viewpoint) return scan_normals({cloud.points, *cloud.viewpoint}, options);
  require_finite(cloud.points);
  return outward_normals(cloud.points, {.neighbours = options.neighbours,
                                        .orientation_neighbours = options.orientation_neighbours});
}

}  // namespace salbench
