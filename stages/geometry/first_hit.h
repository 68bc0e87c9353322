// SPDX-License-Identifier: GPL-3.0-or-later
// The face of a mesh that a ray meets first, or that is nearest to a place, and where, to double precision.
//
// Embree finds the faces that a ray may meet, in float and in the frame below; which of them is nearest, and
// where the ray meets it, is decided in double, among those that float puts no farther behind the nearest one
// than kMargin. The ray is cut there at each hit, so that Embree does not search what is hidden. The
// result depends neither on the order in which it visits its tree, which differs with the number of threads
// that built it, nor on the reciprocal estimates of the processor.
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
  double depth = std::numeric_limits<double>::infinity();  // along the direction, if that is of unit length

  explicit operator bool() const { return face != kNoFace; }
  Vec3 point_in(const Mesh& mesh) const;
};

// A mesh ready for rays. Faces are two-sided; vertices without a face do not count.
class TracedMesh {
 public:
  using Corners = std::array<Vec3, 3>;     // of a face
  static constexpr float kMargin = 0.01F;  // local; thousands of times what float is off by

  // The mesh must outlive it. Throws InputError if the surface area is 0 or not finite.
  explicit TracedMesh(const Mesh& mesh);
  explicit TracedMesh(Mesh&&) = delete;

  Vec3 local_from_mesh(const Vec3& p) const { return (p - origin_) / unit_; }
  Vec3 mesh_from_local(const Vec3& p) const { return origin_ + unit_ * p; }
  const Mesh& mesh() const { return mesh_; }
  Points local_corners() const { return corners_; }  // the points that are corners of faces, once each

  // Appends the faces that a local ray may meet; the first of them is among those no deeper than the limit
  // returned.
  float append_candidates(const Vec3& origin, const Vec3& direction, std::vector<embree::Hit>& hits) const;
  // Faces are looked at after all candidates of several rays are found; until then they arrive from memory.
  void prefetch(std::uint32_t face) const;
  // Takes the face for the first one if the local ray meets it nearer. Embree found it in float: weights that
  // are negative in double come from that, and clamping keeps the point on the face. A face seen exactly
  // edge-on is left to its neighbours.
  void offer(const Vec3& origin, const Vec3& direction, std::uint32_t face, FirstHit& nearest) const;

  // What a ray from any distance meets first; in the coordinates of the mesh, the direction of unit length.
  // Several threads may ask at once.
  FirstHit first_hit(const Vec3& origin, const Vec3& direction) const;

  // The point of the surface that is nearest to a place, of equally near ones that of the first face; none if
  // it is farther than `reach`. Its `depth` is the distance.
  FirstHit nearest(const Vec3& place, double reach) const;

 private:
  const Mesh& mesh_;
  double unit_;  // in the mesh, as the origin
  Vec3 origin_;
  double radius_ = 0;  // local: the largest distance of a corner to the origin
  std::vector<Vec3> corners_;
  std::vector<Corners> of_faces_;  // a copy for each face: its vertices lie far apart in memory
  embree::Scene scene_;
};

}  // namespace salbench
