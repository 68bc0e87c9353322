// SPDX-License-Identifier: GPL-3.0-or-later
// The angle deficit of Meyer et al. without the division by the area of the vertex, so that a point of a fine
// mesh has the curvature of its own surroundings alone.
#include "stages/models/gc.h"

#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>

#include "stages/core/check.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/geometry/support.h"

namespace salbench {

ScalarField gc_saliency(Points points, Surface surface, const GcOptions&) {
  check_faces(points.size(), surface);
  const std::vector<Vec3> placed = in_units_of_radius(points);
  ScalarField angles(points.size(), 0);
  std::vector<bool> has_turn(points.size(), false);
  std::map<std::pair<std::int32_t, std::int32_t>, int> faces_at;  // [edge]
  for (const Triangle& face : surface)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = face[k], b = face[(k + 1) % 3], c = face[(k + 2) % 3];
      const Vec3 u = placed[index(b)] - placed[index(a)], v = placed[index(c)] - placed[index(a)];
      angles[index(a)] += std::atan2(u.cross(v).norm(), u.dot(v));
      has_turn[index(a)] = true;
      ++faces_at[std::minmax(a, b)];
    }
  for (const auto& [edge, count] : faces_at)
    if (count != 2) has_turn[index(edge.first)] = has_turn[index(edge.second)] = false;
  ScalarField deficit(points.size(), 0);
  for (std::size_t i = 0; i < deficit.size(); ++i)
    if (has_turn[i]) deficit[i] = std::abs(2 * std::numbers::pi - angles[i]);
  return deficit;
}

}  // namespace salbench
