// SPDX-License-Identifier: GPL-3.0-or-later
// Sliding midpoint [maneewongvatana1999], in the order of nanoflann 1.4 [blanco2014], on whose trees older
// results depend: a box is cut across the middle of its longest side, and the plane slides to the points if
// they all lie on one side. Points on the plane go to the smaller half.
#include "stages/geometry/kd_nodes.h"

#include <algorithm>
#include <utility>

namespace salbench {
namespace {

// Sides within this fraction of the longest one count as longest.
constexpr double kAlike = 1e-5;

struct Place {
  Vec3 point;
  std::int32_t index;
};

struct Box {
  Vec3 low, high;
};

struct Interval {
  double low, high;
};

struct Cut {
  Eigen::Index axis;
  double plane;
};

// Moves places that satisfy the condition to the front, and returns their number. Needed because
// std::partition leaves an unspecified order.
template <class Condition>
std::size_t move_to_front(std::span<Place> places, const Condition& condition) {
  std::size_t front = 0, back = places.size();
  while (true) {
    while (front < back && condition(places[front])) ++front;
    while (front < back && !condition(places[back - 1])) --back;
    if (front == back) return front;
    std::swap(places[front++], places[--back]);
  }
}

Box box_of(std::span<const Place> places) {
  Box box{places[0].point, places[0].point};
  for (const Place& place : places.subspan(1)) {
    box.low = box.low.cwiseMin(place.point);
    box.high = box.high.cwiseMax(place.point);
  }
  return box;
}

Interval extent(std::span<const Place> places, Eigen::Index axis) {
  Interval interval{places[0].point[axis], places[0].point[axis]};
  for (const Place& place : places.subspan(1)) {
    interval.low = std::min(interval.low, place.point[axis]);
    interval.high = std::max(interval.high, place.point[axis]);
  }
  return interval;
}

// Cuts the longest side; among several, the one with the largest extent of the points.
Cut cut_of(std::span<const Place> places, const Box& box) {
  const Vec3 sides = box.high - box.low;
  const double longest = sides.maxCoeff();
  Eigen::Index axis = 0;
  Interval points{0, -1};
  for (Eigen::Index candidate = 0; candidate < 3; ++candidate) {
    if (!(sides[candidate] > (1 - kAlike) * longest)) continue;
    const Interval along = extent(places, candidate);
    if (along.high - along.low > points.high - points.low) {
      axis = candidate;
      points = along;
    }
  }
  if (points.high < points.low) points = extent(places, axis);
  return {axis, std::clamp((box.low[axis] + box.high[axis]) / 2, points.low, points.high)};
}

// Returns the number of places on the near side.
std::size_t divide(std::span<Place> places, const Cut& cut) {
  const std::size_t before =
      move_to_front(places, [&](const Place& p) { return p.point[cut.axis] < cut.plane; });
  const std::size_t on_plane =
      move_to_front(places.subspan(before), [&](const Place& p) { return p.point[cut.axis] <= cut.plane; });
  return std::clamp(places.size() / 2, before, before + on_plane);
}

struct Builder {
  std::vector<Place> places;
  std::vector<KdNode> nodes;

  // Adds the node of a range with its descendants, and returns the box of its points. `box`: region left by
  // the cuts above.
  Box add(std::size_t first, std::size_t last, const Box& box) {
    const std::span<Place> own = std::span(places).subspan(first, last - first);
    const std::size_t node = nodes.size();
    nodes.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last)});
    if (own.size() <= kLeaf) return box_of(own);

    const Cut cut = cut_of(own, box);
    const std::size_t middle = first + divide(own, cut);
    Box near = box, far = box;
    near.high[cut.axis] = far.low[cut.axis] = cut.plane;
    near = add(first, middle, near);
    nodes[node].far = static_cast<std::uint32_t>(nodes.size() - node);
    far = add(middle, last, far);
    nodes[node].axis = static_cast<std::uint32_t>(cut.axis);
    nodes[node].low = near.high[cut.axis];
    nodes[node].high = far.low[cut.axis];
    return {near.low.cwiseMin(far.low), near.high.cwiseMax(far.high)};
  }
};

}  // namespace

KdNodes kd_nodes(std::span<const Vec3> points, std::span<const std::int32_t> indices) {
  if (indices.empty()) return {{}, {}, Vec3::Zero(), Vec3::Zero()};
  Builder builder;
  builder.places.reserve(indices.size());
  for (const std::int32_t i : indices) builder.places.push_back({points[static_cast<std::size_t>(i)], i});
  builder.nodes.reserve(4 * indices.size() / kLeaf + 1);
  const auto [low, high] = builder.add(0, indices.size(), box_of(builder.places));

  KdNodes tree{{}, std::move(builder.nodes), low, high};
  tree.order.reserve(indices.size());
  for (const Place& place : builder.places) tree.order.push_back(place.index);
  return tree;
}

}  // namespace salbench
