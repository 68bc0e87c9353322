// SPDX-License-Identifier: GPL-3.0-or-later
// Search over pairs of boxes that recursively halve the points: skips pairs whose points cannot be farther
// apart than the best known pair. Least effective on a sphere, where many pairs are nearly as far apart.
#include <algorithm>
#include <memory>

#include "stages/metrics/surface_graph.h"

namespace salbench {
namespace {

constexpr std::size_t kLeafPoints = 8;

struct BoxNode {
  std::span<const Vec3> points;
  Eigen::AlignedBox3d box;
  std::unique_ptr<BoxNode> first, second;  // null for a leaf
};

std::unique_ptr<BoxNode> box_tree(std::span<Vec3> points) {
  auto node = std::make_unique<BoxNode>(BoxNode{points, {}, {}, {}});
  for (const Vec3& p : points) node->box.extend(p);
  if (points.size() <= kLeafPoints) return node;
  Eigen::Index axis = 0;
  node->box.sizes().maxCoeff(&axis);
  const std::size_t half = points.size() / 2;
  std::ranges::nth_element(points, points.begin() + static_cast<std::ptrdiff_t>(half), {},
                           [&](const Vec3& p) { return p[axis]; });
  node->first = box_tree(points.first(half));
  node->second = box_tree(points.subspan(half));
  return node;
}

// Upper bound of distances between points of the boxes, including rounding.
double farthest(const BoxNode& a, const BoxNode& b) {
  const Vec3 reach = (a.box.max() - b.box.min()).cwiseAbs().cwiseMax((b.box.max() - a.box.min()).cwiseAbs());
  return reach.norm() * (1 + 1e-12);
}

void widen(double& largest, const BoxNode& a, const BoxNode& b) {
  if (farthest(a, b) <= largest) return;
  if (!a.first && !b.first) {
    for (const Vec3& p : a.points)
      for (const Vec3& q : b.points) largest = std::max(largest, (p - q).norm());
    return;
  }
  const bool split_a = a.first && (!b.first || a.points.size() >= b.points.size());
  const BoxNode &whole = split_a ? b : a, &halved = split_a ? a : b;
  const bool second_reaches_farther = farthest(whole, *halved.second) > farthest(whole, *halved.first);
  widen(largest, whole, second_reaches_farther ? *halved.second : *halved.first);
  widen(largest, whole, second_reaches_farther ? *halved.first : *halved.second);
}

}  // namespace

double diameter_of(Points points) {
  if (points.empty()) return 0;
  std::vector<Vec3> sorted(points.begin(), points.end());
  const auto tree = box_tree(sorted);
  double largest = 0;
  widen(largest, *tree, *tree);
  return largest;
}

}  // namespace salbench
