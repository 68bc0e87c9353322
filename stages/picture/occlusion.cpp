// SPDX-License-Identifier: GPL-3.0-or-later
// Interleaved sampling [keller2001]: each pixel of a tile has its own directions, and the mean over any 4 x 4
// pixels includes all of them.
#include "stages/picture/occlusion.h"

#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include <Eigen/Geometry>

namespace salbench {

namespace {

constexpr int kTile = 4;                // pixels
constexpr float kSurfaceDistance = 2;   // limit within a surface, in pixels across the normal
constexpr float kSurfaceCosine = 0.7F;  // limit within a surface, between normals
constexpr float kLift = 1e-3F;          // offset of the rays' origins, in the shape's radius
constexpr float kGrazing = 0.02F;       // cosine to the plane below which a ray would leave through it

// Cosine-distributed directions around +z, spread evenly over the hemisphere by an additive recurrence in two
// dimensions [roberts2018] from a random start, and assigned randomly to the pixels of a tile.
std::vector<Vec3f> directions(std::size_t count, Rng& rng) {
  constexpr double kPlastic = 1.32471795724474602596;  // x^3 = x + 1
  const double shift_u = rng.uniform(), shift_v = rng.uniform();
  std::vector<Vec3f> all(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto n = static_cast<double>(i);
    const double u = std::fmod(shift_u + n / kPlastic, 1.0);
    const double angle = 2 * std::numbers::pi * std::fmod(shift_v + n / (kPlastic * kPlastic), 1.0);
    all[i] =
        Vec3(std::sqrt(u) * std::cos(angle), std::sqrt(u) * std::sin(angle), std::sqrt(1 - u)).cast<float>();
  }
  for (std::size_t i = count; i > 1; --i) std::swap(all[i - 1], all[rng.below(i)]);
  return all;
}

// Two directions orthogonal to a unit vector and to each other, continuous except at z = 0. [duff2017]
std::array<Vec3f, 2> tangents(const Vec3f& n) {
  const float sign = std::copysign(1.0F, n.z());
  const float a = -1 / (sign + n.z()), b = n.x() * n.y() * a;
  return {Vec3f(1 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()),
          Vec3f(b, sign + n.y() * n.y() * a, -n.y())};
}

float open_part(const embree::Scene& scene, const Site& site, std::span<const Vec3f> local, float reach) {
  const Vec3f origin = site.position + kLift * site.plane_normal;
  const auto [u, v] = tangents(site.normal);
  int open = 0;
  for (const Vec3f& d : local) {
    const Vec3f direction = d.x() * u + d.y() * v + d.z() * site.normal;
    // A smooth normal is not the face's: rays that would pass through the face itself count as free.
    open +=
        direction.dot(site.plane_normal) < kGrazing || !embree::occluded(scene, origin, direction, 0, reach)
            ? 1
            : 0;
  }
  return static_cast<float>(open) / static_cast<float>(local.size());
}

bool same_surface(const Site& a, const Site& b, float pixel) {
  return b.seen && a.normal.dot(b.normal) > kSurfaceCosine &&
         std::abs((b.position - a.position).dot(a.plane_normal)) < kSurfaceDistance * pixel;
}

// Mean over a window of one tile that begins `before` pixels to the left and above each pixel.
std::vector<float> blurred(const std::vector<float>& values, const std::vector<Site>& sites,
                           const ImagePlane& plane, int before) {
  std::vector<float> result(values.size(), 1);
  const auto pixel_per_depth = static_cast<float>(2 * plane.tan_half_field / plane.side);
  for (int row = 0; row < plane.side; ++row)
    for (int column = 0; column < plane.side; ++column) {
      const auto here = static_cast<std::size_t>(row * plane.side + column);
      const Site& site = sites[here];
      if (!site.seen) continue;
      float sum = 0, weight = 0;
      for (int r = std::max(0, row - before); r < std::min(plane.side, row - before + kTile); ++r)
        for (int c = std::max(0, column - before); c < std::min(plane.side, column - before + kTile); ++c) {
          const auto there = static_cast<std::size_t>(r * plane.side + c);
          if (there != here && !same_surface(site, sites[there], pixel_per_depth * site.position.z()))
            continue;
          sum += values[there];
          ++weight;
        }
      result[here] = sum / weight;
    }
  return result;
}

}  // namespace

std::vector<float> openness(const embree::Scene& scene, const std::vector<Site>& sites,
                            const ImagePlane& plane, const PictureOptions& options, Rng rng) {
  std::vector<float> open(sites.size(), 1);
  const auto samples = static_cast<std::size_t>(options.occlusion_samples);
  if (samples == 0) return open;
  const std::vector<Vec3f> all = directions(samples * kTile * kTile, rng);
  const auto reach = static_cast<float>(options.occlusion_reach);
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (!sites[i].seen) continue;
    const std::size_t row = i / static_cast<std::size_t>(plane.side),
                      column = i % static_cast<std::size_t>(plane.side);
    const std::size_t in_tile = row % kTile * kTile + column % kTile;
    open[i] = open_part(scene, sites[i], std::span(all).subspan(in_tile * samples, samples), reach);
  }
  for (const int before : {2, 1, 2, 1}) open = blurred(open, sites, plane, before);  // centred on average
  return open;
}

}  // namespace salbench
