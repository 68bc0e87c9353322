// SPDX-License-Identifier: GPL-3.0-or-later
// Rays from one point through a grid need no tree: going over the faces takes 10-20 ms where Embree's nearest
// hits take 100 ms (400 x 400 pixels, 9 rays each), and it is exact in double precision, without gaps between
// faces, and the same on every machine.
#include "stages/picture/raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace salbench {
namespace {

constexpr double kLeastSlope = 1e-6;
constexpr float kNothing = std::numeric_limits<float>::infinity();

struct Point2 {
  double x, y;  // column and row
};

// Twice the area of the triangle (a, b, p). Exactly the negative for (b, a, p), so that faces on both sides
// of an edge agree on which of them a ray passes.
double edge(const Point2& a, const Point2& b, const Point2& p) {
  return (a.x - p.x) * (b.y - p.y) - (a.y - p.y) * (b.x - p.x);
}

// First and last cell whose centre is at `low` or above and at `high` or below, within the plane.
struct Cells {
  int first, last;
};
Cells cells_between(double low, double high, int side) {
  constexpr double kNone = -1;  // ends before the first cell
  return {static_cast<int>(std::clamp(std::ceil(low - 0.5), 0.0, static_cast<double>(side))),
          static_cast<int>(std::clamp(std::floor(high - 0.5), kNone, side - 1.0))};
}

// A face in the image, turned so that it is counter-clockwise for edge().
struct FlatFace {
  std::array<Point2, 3> corners;
  std::array<double, 3> inverse_depths;

  FlatFace(std::span<const Vec3> points, const Triangle& face, const ImagePlane& plane) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& p = points[static_cast<std::size_t>(face[k])];
      corners[k] = {plane.column(p), plane.row(p)};
      inverse_depths[k] = 1 / p.z();
    }
    if (edge(corners[0], corners[1], corners[2]) >= 0) return;
    std::swap(corners[1], corners[2]);
    std::swap(inverse_depths[1], inverse_depths[2]);
  }

  // The cells of a row that may be within the face: one more on each side than rounding allows.
  Cells span(double y, int side) const {
    double low = -1, high = side + 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const Point2 &a = corners[k], &b = corners[(k + 1) % 3];
      const double slope = a.y - b.y, at_zero = edge(a, b, {0, y});
      if (std::abs(slope) < kLeastSlope) continue;  // along the row: rounding decides, in depth_at
      if (slope > 0) low = std::max(low, -at_zero / slope);
      if (slope < 0) high = std::min(high, -at_zero / slope);
    }
    return cells_between(low - 1, high + 1, side);
  }

  // Infinity where the ray passes the face by.
  float depth_at(const Point2& p) const {
    const double e0 = edge(corners[1], corners[2], p), e1 = edge(corners[2], corners[0], p),
                 e2 = edge(corners[0], corners[1], p);
    if (e0 < 0 || e1 < 0 || e2 < 0) return kNothing;
    const double sum = e0 + e1 + e2;
    if (!(sum > 0)) return kNothing;  // edge-on
    return static_cast<float>(sum /
                              (e0 * inverse_depths[0] + e1 * inverse_depths[1] + e2 * inverse_depths[2]));
  }

  void draw(std::int32_t index, const ImagePlane& plane, Seen& seen) const {
    const auto [top, bottom] = std::minmax({corners[0].y, corners[1].y, corners[2].y});
    const Cells rows = cells_between(top, bottom, plane.side);
    for (int row = rows.first; row <= rows.last; ++row) {
      const Cells columns = span(row + 0.5, plane.side);
      for (int column = columns.first; column <= columns.last; ++column) {
        const auto cell = static_cast<std::size_t>(row * plane.side + column);
        const float depth = depth_at({column + 0.5, row + 0.5});
        if (!(depth < seen.depth[cell])) continue;
        seen.depth[cell] = depth;
        seen.primitive[cell] = index;
      }
    }
  }
};

struct Hit {
  double depth, distance;  // from the camera along z; from the centre across the disc's ray, in radii
};

// How far the disc reaches from its centre along each axis of eye space: half the box around an ellipse.
Vec3 half_box(const Disc& disc) {
  const Vec3 across = disc.normal.cross(disc.ray);
  const double sine = across.norm();
  if (sine < 1e-6) return Vec3::Constant(disc.radius);  // faces the scanner
  const Vec3 narrow = disc.radius * across / sine, wide = disc.reach * across.cross(disc.normal) / sine;
  return (narrow.cwiseAbs2() + wide.cwiseAbs2()).cwiseSqrt();
}

// Cells around a coordinate of the centre that the disc may reach.
Cells extent(const Disc& disc, const Vec3& half, Eigen::Index axis, double at, const ImagePlane& plane) {
  const double nearest = disc.centre.z() - half.z();
  if (!(nearest > 0)) return {0, plane.side - 1};
  const double slope = std::abs(disc.centre[axis]) / disc.centre.z();
  const double cells = (half[axis] + slope * half.z()) / nearest / plane.tan_half_field / 2 * plane.side;
  return cells_between(at - cells, at + cells, plane.side);
}

// Calls visit(cell, hit) for every cell whose ray meets the disc.
template <class Visit>
void for_each_hit(const Disc& disc, const ImagePlane& plane, const Visit& visit) {
  const double along_normal = disc.normal.dot(disc.centre);
  const Vec3 half = half_box(disc);
  const Cells columns = extent(disc, half, 0, plane.column(disc.centre), plane);
  const Cells rows = extent(disc, half, 1, plane.row(disc.centre), plane);
  for (int row = rows.first; row <= rows.last; ++row)
    for (int column = columns.first; column <= columns.last; ++column) {
      const Vec3 ray = plane.ray(column + 0.5, row + 0.5);
      const double depth = along_normal / disc.normal.dot(ray);
      const Vec3 offset = depth * ray - disc.centre;
      const double along = offset.dot(disc.ray), squared = offset.squaredNorm();
      const double across_squared = std::max(0.0, squared - along * along);
      if (across_squared <= disc.radius * disc.radius && squared <= disc.reach * disc.reach)  // false for NaN
        visit(static_cast<std::size_t>(row * plane.side + column),
              Hit{depth, std::sqrt(across_squared) / disc.radius});
    }
}

}  // namespace

Seen::Seen(const ImagePlane& plane)
    : primitive(plane.cells(), -1), depth(plane.cells(), kNothing), normal(plane.cells(), Vec3f::Zero()) {}

Seen see_faces(std::span<const Vec3> points, std::span<const Triangle> faces, const ImagePlane& plane) {
  Seen seen(plane);
  for (std::size_t f = 0; f < faces.size(); ++f)
    FlatFace(points, faces[f], plane).draw(static_cast<std::int32_t>(f), plane, seen);
  return seen;
}

// Discs at one place of the surface overlap, so that the frontmost alone would give ragged cells: those share
// it that are not farther behind the front than their radius.
Seen see_discs(std::span<const Disc> discs, const ImagePlane& plane) {
  Seen seen(plane);
  std::vector<float> front(plane.cells(), kNothing), nearest(plane.cells(), kNothing);
  for (std::size_t i = 0; i < discs.size(); ++i) {
    const Vec3f normal = discs[i].normal.cast<float>();
    const auto thickness = static_cast<float>(discs[i].radius);
    for_each_hit(discs[i], plane, [&](std::size_t cell, const Hit& hit) {
      const auto depth = static_cast<float>(hit.depth), distance = static_cast<float>(hit.distance);
      if (depth > front[cell] + thickness) return;
      if (depth < front[cell] - thickness) {  // a surface before the one so far
        nearest[cell] = kNothing;
        seen.normal[cell].setZero();
      }
      front[cell] = std::min(front[cell], depth);
      seen.normal[cell] += (1.001F - distance * distance) * normal;
      if (!(distance < nearest[cell])) return;
      nearest[cell] = distance;
      seen.primitive[cell] = static_cast<std::int32_t>(i);
      seen.depth[cell] = depth;
    });
  }
  for (Vec3f& normal : seen.normal) normal.normalize();
  return seen;
}

Vec3 weights_at(std::span<const Vec3> points, const Triangle& face, const Vec3& ray) {
  const Vec3 &a = points[static_cast<std::size_t>(face[0])], &b = points[static_cast<std::size_t>(face[1])],
             &c = points[static_cast<std::size_t>(face[2])];
  Vec3 weights(ray.dot(b.cross(c)), ray.dot(c.cross(a)), ray.dot(a.cross(b)));
  if (weights.sum() < 0) weights = -weights;
  weights = weights.cwiseMax(0.0);
  return weights / weights.sum();
}

}  // namespace salbench
