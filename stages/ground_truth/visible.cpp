// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/ground_truth/visible.h"

#include <limits>

#include "stages/core/parallel.h"
#include "stages/geometry/embree.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {
namespace {

constexpr float kFreeOfOwnFaces = 1e-4F;  // R: where rays begin
constexpr std::size_t kRayGrain = 1024;   // points of a range

}  // namespace

std::vector<bool> visible_points(Points points, Surface surface, const Viewpoint& from) {
  check_faces(points.size(), surface);
  const std::vector<Vec3> places = in_units_of_radius(points);
  if (surface.empty()) return std::vector<bool>(points.size(), true);
  const Vec3 viewpoint =
      from.at_infinity ? from.place : Vec3((from.place - centroid(points)) / bounding_radius(points));
  const embree::Scene scene = embree::scene_of_triangles(places, surface);
  std::vector<char> visible(points.size());  // a bool each, that threads may write
  parallel_ranges(points.size(), kRayGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const Vec3 way = from.at_infinity ? viewpoint : Vec3(viewpoint - places[i]);
      const float far =
          from.at_infinity ? std::numeric_limits<float>::infinity() : static_cast<float>(way.norm());
      visible[i] = far <= kFreeOfOwnFaces ||
                   !embree::occluded(scene, places[i].cast<float>(), way.stableNormalized().cast<float>(),
                                     kFreeOfOwnFaces, far);
    }
  });
  return {visible.begin(), visible.end()};
}

}  // namespace salbench
