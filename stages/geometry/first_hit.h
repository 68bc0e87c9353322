// SPDX-License-Identifier: GPL-3.0-or-later
// First face of a mesh that a ray meets, or the face nearest to a position, with the location on it in double
// precision.
//
// Embree finds candidates in float, in the frame below; the nearest of those that float puts at most kMargin
// behind the first, and the location on it, are determined in double. The ray is shortened at each hit, so
// that Embree does not search hidden parts. The result is independent of the order in which Embree visits its
// tree, which varies with the number of threads that built it, and of the processor's reciprocal estimates.
//
// Frame of tracing, "local": the area centroid at the origin, the square root of the surface area as unit.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "stages/core/types.h"
#include "stages/geometry/embree.h"

namespace salbench {

inline constexpr std::uint32_t kNoFace = std::numeric_limits<std::uint32_t>::max();

struct FirstHit {
  std::uint32_t face = kNoFace;
  Vec3 weights = Vec3::Zero();                             // barycentric, of the face's corners
  double depth = std::numeric_limits<double>::infinity();  // along the direction, if it has unit length

  explicit operator bool() const { return face != kNoFace; }
  Vec3 point_in(const Mesh& mesh) const;
};

// A mesh ready for rays. Faces are two-sided; vertices without a face are ignored.
class TracedMesh {
 public:
  using Corners = std::array<Vec3, 3>;     // a face's corners
  static constexpr float kMargin = 0.01F;  // local; thousands of times the error of float

  // The mesh must outlive it. Throws InputError if the surface area is 0 or not finite.
  explicit TracedMesh(const Mesh& mesh);
  explicit TracedMesh(Mesh&&) = delete;

  Vec3 local_from_mesh(const Vec3& p) const { return (p - origin_) / unit_; }
  Vec3 mesh_from_local(const Vec3& p) const { return origin_ + unit_ * p; }
  const Mesh& mesh() const { return mesh_; }
  Points local_corners() const { return corners_; }  // points that are corners of faces, each once

  // Appends the faces that a local ray may meet; the first hit is among those up to the returned limit of
  // depth.
  float append_candidates(const Vec3& origin, const Vec3& direction, std::vector<embree::Hit>& hits) const;
  // Faces are examined after the candidates of several rays have been found; prefetching hides memory
  // latency.
  void prefetch(std::uint32_t face) const;
  // Replaces the nearest hit if the local ray meets the face nearer. Candidates come from float arithmetic:
  // weights may be negative in double, and are clamped to the face. A face seen exactly edge-on is left to
  // its neighbours.
  void offer(const Vec3& origin, const Vec3& direction, std::uint32_t face, FirstHit& nearest) const;

  // First hit of a ray at any distance, in mesh coordinates, with a unit direction. Thread-safe.
  FirstHit first_hit(const Vec3& origin, const Vec3& direction) const;

  // Point of the surface nearest to a position, on the first face among equally near ones; none beyond
  // `reach`. Its `depth` is the distance.
  FirstHit nearest(const Vec3& place, double reach) const;

 private:
  const Mesh& mesh_;
  double unit_;  // in mesh coordinates, like the origin
  Vec3 origin_;
  double radius_ = 0;  // local: the largest distance of a corner to the origin
  std::vector<Vec3> corners_;
  std::vector<Corners> of_faces_;  // copied per face, since its vertices lie far apart in memory
  embree::Scene scene_;
};

}  // namespace salbench
