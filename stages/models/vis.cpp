// SPDX-License-Identifier: GPL-3.0-or-later
// Directions come in opposite pairs, of which a point uses the one above it: every point has the same number
// of rays, and on a convex shape all of them are free.
#include "stages/models/vis.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "stages/core/check.h"
#include "stages/core/parallel.h"
#include "stages/geometry/embree.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/geometry/neighbours.h"
#include "stages/models/interpolated.h"

namespace salbench {
namespace {

constexpr double kLift = 1e-4;         // R: distance of the rays' origins from the surface
constexpr std::size_t kDiscSpan = 7;   // nearest points, including itself, covered by a point's disc
constexpr double kFreeOfDiscs = 2;     // disc radii: nearer discs belong to the point's own surface
constexpr std::size_t kRayGrain = 64;  // points per task, each with many rays

// One direction of each pair, over the half sphere z > 0: a spiral with evenly spaced turns and steps.
std::vector<Eigen::Vector3f> half_of_directions(std::int32_t count) {
  std::vector<Eigen::Vector3f> directions;
  for (std::int32_t i = 0; i < count; ++i) {
    const double z = 1 - (i + 0.5) / count, flat = std::sqrt(1 - z * z);
    const double angle = 2 * std::numbers::pi * std::fmod(i * std::numbers::phi, 1.0);
    directions.push_back(Vec3(flat * std::cos(angle), flat * std::sin(angle), z).cast<float>());
  }
  return directions;
}

// Occluding geometry, and the distance from a point at which it begins.
struct Occluder {
  embree::Scene scene;
  std::vector<double> disc_radii;  // n; empty for a surface

  float near(std::size_t i) const {
    return disc_radii.empty() ? 0 : static_cast<float>(kFreeOfDiscs * disc_radii[i]);
  }
};

Occluder occluder_of(const std::vector<Vec3>& places, const Normals& normals, Surface surface) {
  if (!surface.empty()) return {embree::scene_of_triangles(places, surface), {}};
  std::vector<double> radii(places.size());
  const KdTree tree(places);
  parallel_ranges(places.size(), kPointGrain, [&](std::size_t first, std::size_t last) {
    std::vector<Neighbour> nearest;
    for (std::size_t i = first; i < last; ++i) {
      tree.nearest(places[i], kDiscSpan, nearest);
      radii[i] = std::sqrt(nearest.back().distance_squared);
    }
  });
  return {embree::scene_of_discs(places, normals, radii), radii};
}

double open_part(const Occluder& occluder, const Vec3& place, const Vec3& normal, float near,
                 std::span<const Eigen::Vector3f> directions) {
  const Eigen::Vector3f origin = (place + kLift * normal).cast<float>(), up = normal.cast<float>();
  int open = 0;
  for (const Eigen::Vector3f& direction : directions) {
    const Eigen::Vector3f above = direction.dot(up) < 0 ? Eigen::Vector3f(-direction) : direction;
    open +=
        embree::occluded(occluder.scene, origin, above, near, std::numeric_limits<float>::infinity()) ? 0 : 1;
  }
  return static_cast<double>(open) / static_cast<double>(directions.size());
}

}  // namespace

ScalarField vis_saliency(Points points, const Normals& normals, Surface surface, const VisOptions& options) {
  check(options);
  CHECK_EQ(normals.size(), points.size());
  check_faces(points.size(), surface);
  const std::vector<Vec3> places = in_units_of_radius(points);
  const Occluder occluder = occluder_of(places, normals, surface);
  const std::vector<Eigen::Vector3f> directions = half_of_directions(options.directions);
  const auto seen = [&](std::size_t i) {
    return open_part(occluder, places[i], normals[i], occluder.near(i), directions);
  };

  const auto most = static_cast<std::size_t>(options.sample);
  std::vector<std::int32_t> sample;
  if (places.size() > most) sample = KdTree(places).even_sample(most);
  ScalarField visibility(sample.empty() ? places.size() : sample.size());
  parallel_ranges(visibility.size(), kRayGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k)
      visibility[k] = seen(sample.empty() ? k : static_cast<std::size_t>(sample[k]));
  });
  if (sample.empty()) return visibility;
  std::vector<Vec3> sampled;
  for (const std::int32_t i : sample) sampled.push_back(places[static_cast<std::size_t>(i)]);
  return interpolated(places, KdTree(sampled), visibility);
}

}  // namespace salbench
