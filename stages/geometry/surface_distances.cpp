// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/surface_distances.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace salbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Relative to the reach: rounding differences of equal paths. Around slivers distances shrink forever, by
// ever less; so each gain of a point must be at least twice the previous one, which allows some forty.
constexpr double kLeastGain = 1e-12;
constexpr auto farther = [](const ReachedPoint& a, const ReachedPoint& b) {
  return a.distance > b.distance || (a.distance == b.distance && a.index > b.index);
};

}  // namespace

SurfaceDistances::SurfaceDistances(Points points, Surface faces)
    : points_(points),
      faces_(faces),
      distance_(points.size(), kInfinity),
      least_gain_(points.size(), kLeastGain) {
  check_faces(points.size(), faces);
  faces_of_ = adjacency_of(points.size(), [&](auto&& visit) {
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (const std::int32_t v : faces[f]) visit(index(v), static_cast<std::int32_t>(f));
  });
}

// With the other two corners on an axis, the source lies below it as their distances determine. If the
// straight line from there crosses the edge between them, it is the path; otherwise the path follows an edge.
double SurfaceDistances::across(const Triangle& face, std::size_t k) const {
  const std::int32_t a = face[(k + 1) % 3], b = face[(k + 2) % 3];
  const double from_a = distance_[index(a)], from_b = distance_[index(b)];
  const Vec3 along = at(points_, b) - at(points_, a), to = at(points_, face[k]) - at(points_, a);
  const double by_edges = std::min(from_a + to.norm(), from_b + (to - along).norm());
  const double edge = along.norm();
  if (!(edge > 0) || std::max(from_a, from_b) == kInfinity) return by_edges;
  const double x = to.dot(along) / edge, y = std::sqrt(std::max(0.0, to.squaredNorm() - x * x));
  const double source_x = (edge + (from_a - from_b) * (from_a + from_b) / edge) / 2;
  const double source_y = std::sqrt(std::max(0.0, from_a * from_a - source_x * source_x));
  if (!(y + source_y > 0)) return by_edges;
  const double crossing = (source_x * y + x * source_y) / (y + source_y);
  return crossing >= 0 && crossing <= edge ? std::hypot(x - source_x, y + source_y) : by_edges;
}

void SurfaceDistances::offer(std::int32_t point, double distance, double reach) {
  double &best = distance_[index(point)], &least_gain = least_gain_[index(point)];
  if (!(distance < best - least_gain * reach) || distance > reach) return;
  if (best == kInfinity) reached_.push_back({point, 0});
  least_gain = best == kInfinity ? kLeastGain : 2 * least_gain;
  best = distance;
  open_.push_back({point, distance});
  std::ranges::push_heap(open_, farther);
}

// Near the source, the neighbour from which a path comes may be farther than the point that it leads to: a
// point whose distance shrinks is visited again. Distances never fall below those of the unfolded faces,
// since they grow with those from which they are computed.
std::span<const ReachedPoint> SurfaceDistances::from(std::uint32_t face, const Vec3& weights, double reach) {
  for (const ReachedPoint& point : reached_) distance_[index(point.index)] = kInfinity;
  reached_.clear();
  Vec3 place = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k)
    place += weights[static_cast<Eigen::Index>(k)] * at(points_, faces_[face][k]);
  for (const std::int32_t v : faces_[face]) offer(v, (at(points_, v) - place).norm(), reach);
  while (!open_.empty()) {
    std::ranges::pop_heap(open_, farther);
    const auto [point, distance] = open_.back();
    open_.pop_back();
    if (distance > distance_[index(point)]) continue;
    for (const std::int32_t f : faces_of_.of(index(point))) {
      const Triangle& around = faces_[index(f)];
      for (std::size_t k = 0; k < 3; ++k)
        if (around[k] != point) offer(around[k], across(around, k), reach);
    }
  }
  for (ReachedPoint& point : reached_) point.distance = distance_[index(point.index)];
  std::ranges::sort(reached_, [](const auto& a, const auto& b) { return farther(b, a); });
  return reached_;
}

}  // namespace salbench
