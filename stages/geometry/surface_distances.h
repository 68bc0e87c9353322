// SPDX-License-Identifier: GPL-3.0-or-later
// Distances over a surface from a position on one of its faces.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stages/geometry/mesh_ops.h"

namespace salbench {

// Fast marching from face to face, each unfolded into the plane of the one before it: exact on a plane, where
// shortest paths along edges are up to 15 % too long. Paths follow faces only: other parts of a shape are
// unreachable. The workspace is reused between calls, so the cost of a call depends only on the points
// reached. [novotni2002]
class SurfaceDistances {
 public:
  // The points and faces must outlive it. Throws InputError for a face whose point does not exist.
  SurfaceDistances(Points points, Surface faces);

  // Points up to a distance from the position with these barycentric weights, nearest first; valid until the
  // next call.
  std::span<const ReachedPoint> from(std::uint32_t face, const Vec3& weights, double reach);

 private:
  // Distance of corner k of a face over the face, from the distances of the other two.
  double across(const Triangle& face, std::size_t k) const;
  void offer(std::int32_t point, double distance, double reach);

  Points points_;
  Surface faces_;
  Adjacency faces_of_;            // faces around each point
  std::vector<double> distance_;  // infinity if not reached
  std::vector<double> least_gain_;
  std::vector<ReachedPoint> open_, reached_;
};

}  // namespace salbench
