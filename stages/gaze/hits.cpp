// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/gaze/hits.h"

#include <cmath>

#include <fmt/format.h>

#include "stages/core/errors.h"
#include "stages/core/parallel.h"

namespace salbench {
namespace {

constexpr std::size_t kGrain = 256;  // rays

// Direction nearest to `ahead` (of unit length) that meets the segment from a to b, as seen from the eye at
// the origin; returned as the weight of b.
double nearest_on_segment(const Vec3& ahead, const Vec3& a, const Vec3& b) {
  const Vec3 across = a.cross(b);
  const Vec3 below = ahead - across * (ahead.dot(across) / across.squaredNorm());  // onto their plane
  const double of_a = below.cross(b).dot(across),
               of_b = a.cross(below).dot(across);  // below = of_a a + of_b b
  if (of_a > 0 && of_b > 0) return of_b / (of_a + of_b);
  return a.normalized().dot(ahead) >= b.normalized().dot(ahead) ? 0 : 1;
}

// The nearest point to a ray that misses a shape lies on the outline, which consists of edges. The face of
// the nearest edge is visible: a face in front of it would have an edge nearer to the ray.
GazeHit snapped(const Mesh& mesh, const GazeRay& ray, double degrees) {
  const Vec3 ahead = ray.direction.normalized();
  double best = std::cos(degrees * kRadiansPerDegree);
  GazeHit hit;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      const Vec3 a = mesh.vertices[index(mesh.faces[f][k])] - ray.origin;
      const Vec3 b = mesh.vertices[index(mesh.faces[f][next])] - ray.origin;
      const double share = nearest_on_segment(ahead, a, b);
      const Vec3 point = (1 - share) * a + share * b;
      const double depth = point.norm(), cosine = point.dot(ahead) / depth;
      if (!(cosine > best || (cosine == best && depth < hit.depth))) continue;
      best = cosine;
      hit.face = static_cast<std::uint32_t>(f);
      hit.weights = Vec3::Zero();
      hit.weights[static_cast<Eigen::Index>(k)] = 1 - share;
      hit.weights[static_cast<Eigen::Index>(next)] = share;
      hit.depth = depth;
      hit.snapped = true;
    }
  return hit;
}

}  // namespace

std::vector<GazeHit> gaze_hits(const Mesh& mesh, std::span<const GazeRay> rays, const HitOptions& options) {
  const TracedMesh traced(mesh);
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (!rays[i].origin.allFinite() || !std::isnormal(rays[i].direction.squaredNorm()))
      throw ShapeError(fmt::format("ray {}: it is not finite, or has no direction", i + 1));
  std::vector<GazeHit> hits(rays.size());
  parallel_ranges(rays.size(), kGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const FirstHit hit = traced.first_hit(rays[i].origin, rays[i].direction.normalized());
      hits[i] = hit || options.snap == 0 ? GazeHit{hit} : snapped(mesh, rays[i], options.snap);
    }
  });
  return hits;
}

}  // namespace salbench
