// SPDX-License-Identifier: GPL-3.0-or-later
// Brute-force reference for rays.
#pragma once

#include "stages/geometry/first_hit.h"

namespace salbench {

// Nearest of all faces that the ray meets, in double; the depth is in units of the direction's length.
inline FirstHit met_by(const Mesh& mesh, const Vec3& origin, const Vec3& direction) {
  FirstHit nearest;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const Vec3 a = at(mesh.vertices, mesh.faces[f][0]) - origin;
    const Vec3 b = at(mesh.vertices, mesh.faces[f][1]) - origin;
    const Vec3 c = at(mesh.vertices, mesh.faces[f][2]) - origin;
    const double across = (b - a).cross(c - a).dot(direction);
    if (across == 0) continue;
    const Vec3 shares =
        Vec3(b.cross(c).dot(direction), c.cross(a).dot(direction), a.cross(b).dot(direction)) / across;
    const double depth =
        (shares[0] * a + shares[1] * b + shares[2] * c).dot(direction) / direction.squaredNorm();
    if (shares.minCoeff() < 0 || depth < 0 || depth > nearest.depth) continue;
    nearest = {static_cast<std::uint32_t>(f), shares, depth};
  }
  return nearest;
}

}  // namespace salbench
