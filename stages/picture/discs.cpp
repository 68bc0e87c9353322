// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/picture/discs.h"

#include <algorithm>
#include <cmath>

#include "stages/core/field.h"
#include "stages/geometry/neighbours.h"

namespace salbench {
namespace {

constexpr double kRadius = 0.8;       // steps of the scanner's grid; from 0.71 on, the discs of a square meet
constexpr double kLeastCosine = 0.1;  // between normal and ray: discs of steeper surfaces are not longer

constexpr std::size_t kAround = 6;       // points around a point of an even surface
constexpr double kPartOfDistance = 0.9;  // to the farthest of them: less leaves more of scattered points open
constexpr double kMostMedians = 4;       // of the radii: stray points get no large discs

}  // namespace

// The angle between neighbouring rays of the scanner is the median of those between nearest points.
std::vector<Disc> discs_of(const Scan& scan, const Normals& normals, const Camera& camera) {
  const Vec3 scanner = camera.eye_from_world(scan.camera);
  std::vector<Vec3> points;
  for (const Vec3& p : scan.points) points.push_back(camera.eye_from_world(p));
  const KdTree tree(points);
  std::vector<Disc> discs;
  std::vector<double> angles;
  std::vector<Neighbour> nearest;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double distance = (points[i] - scanner).norm();
    tree.nearest(points[i], 2, nearest);
    angles.push_back(std::sqrt(nearest[1].distance_squared) / distance);
    const Vec3 ray = (points[i] - scanner) / distance, normal = camera.eye_from_world_direction(normals[i]);
    discs.push_back({points[i], normal.dot(ray) > 0 ? Vec3(-normal) : normal, ray});
  }
  const double angle = angles.empty() ? 0 : upper_median(std::move(angles));
  for (Disc& disc : discs) {
    disc.radius = kRadius * angle * (disc.centre - scanner).norm();
    disc.reach = disc.radius / std::max(-disc.normal.dot(disc.ray), kLeastCosine);
  }
  return discs;
}

std::vector<Disc> discs_of(Points in_world, const Normals& normals, const Camera& camera) {
  std::vector<Vec3> points;
  for (const Vec3& p : in_world) points.push_back(camera.eye_from_world(p));
  const KdTree tree(points);
  std::vector<Disc> discs;
  std::vector<double> radii;
  std::vector<Neighbour> nearest;
  for (std::size_t i = 0; i < points.size(); ++i) {
    tree.nearest(points[i], kAround + 1, nearest);
    radii.push_back(kPartOfDistance * std::sqrt(nearest.back().distance_squared));
    const Vec3 normal = camera.eye_from_world_direction(normals[i]);
    const Vec3 front = normal.dot(points[i]) > 0 ? Vec3(-normal) : normal;
    discs.push_back({points[i], front, -front});
  }
  const double most = radii.empty() ? 0 : kMostMedians * upper_median(radii);
  for (std::size_t i = 0; i < discs.size(); ++i) discs[i].reach = discs[i].radius = std::min(radii[i], most);
  return discs;
}

}  // namespace salbench
