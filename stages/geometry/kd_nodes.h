// SPDX-License-Identifier: GPL-3.0-or-later
// The boxes of a k-d tree, and which points lie in which. Searches are in neighbours.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

inline constexpr std::size_t kLeaf = 12;  // points at most; decides which points are an even sample

// Places are positions in the tree's order, in which the points of each node lie beside each other.
struct KdNode {
  std::uint32_t first, last;  // its points, by their places
  std::uint32_t far = 0;      // nodes from here to the far child; the near one comes next. 0: a leaf
  std::uint32_t axis = 0;     // that the children lie side by side along
  double low = 0, high = 0;   // edges of the gap: the near child ends at low, the far one begins at high

  bool is_leaf() const { return far == 0; }
  const KdNode& near_child() const { return this[1]; }
  const KdNode& far_child() const { return this[far]; }
};

struct KdNodes {
  std::vector<std::int32_t> order;  // indices of points
  std::vector<KdNode> nodes;        // the root first, each before its children; empty without points
  Vec3 low, high;                   // corners of the box of all points
};

// The tree over the points of these indices. Coordinates are finite.
KdNodes kd_nodes(std::span<const Vec3> points, std::span<const std::int32_t> indices);

}  // namespace salbench
