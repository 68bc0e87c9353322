// SPDX-License-Identifier: GPL-3.0-or-later
// Partial meshes: a surface over the points of a scan or a point cloud, for the models that need edges.
// [tasse2016]
#pragma once

#include <cstdint>

#include "stages/core/options.h"
#include "stages/core/types.h"

namespace salbench {

struct SurfaceOptions {
  double reach = 2.5;                    // longest edge, in distances to the point's nearest other point
  double longest_edge = 8;               // longest edge, in median distances to the nearest other point
  std::int32_t neighbours = 30;          // number of nearest points that an edge may lead to
  double max_normal_angle_degrees = 60;  // limit between the normals of a face's corners
  double smallest_angle = 10;            // degrees in a face, where possible
  double largest_angle = 120;            // degrees in a face

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("reach", self.reach,
          {"longest edge of a point", "distances to its nearest other point", between(1, 100)});
    visit("longest_edge", self.longest_edge,
          {"longest edge of all", "median distances to the nearest other point", between(1, 1000)});
    visit("neighbours", self.neighbours,
          {"nearest points that an edge may lead to", "points", between(3, 1000)});
    visit("steepest_degrees", self.max_normal_angle_degrees,
          {"largest angle between normals across a face", "degrees", between(1, 180)});
    visit("smallest_angle", self.smallest_angle,
          {"smallest angle of a face, where possible", "degrees", between(0, 60)});
    visit("largest_angle", self.largest_angle, {"largest angle of a face", "degrees", between(60, 180)});
  }
};

// f x 3 indices of the points, by greedy projection triangulation; counter-clockwise as seen from the side to
// which the normals point. No two faces traverse an edge in the same direction. Depth jumps stay open, and
// there may be holes and points without a face. The result is empty for fewer than three points, and if the
// median distance to the nearest other point is 0. Takes one unit normal per point; all values must be
// finite. [marton2009]
Faces partial_mesh(Points points, const Normals& normals, const SurfaceOptions& options = {});

}  // namespace salbench
