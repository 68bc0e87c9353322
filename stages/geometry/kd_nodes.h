// SPDX-License-Identifier: GPL-3.0-or-later
// Boxes of a k-d tree and the points in them. Searches are in neighbours.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

inline constexpr std::size_t kLeaf = 12;  // maximum of points; affects which points form an even sample

// Places are positions in the tree's order, in which the points of a node are contiguous.
struct KdNode {
  std::uint32_t first, last;  // range of its points' places
  std::uint32_t far = 0;      // offset to the far child; the near child follows directly. 0: a leaf
  std::uint32_t axis = 0;     // axis of the cut
  double low = 0, high = 0;   // gap: the near child ends at low, the far one begins at high

  bool is_leaf() const { return far == 0; }
  const KdNode& near_child() const { return this[1]; }
  const KdNode& far_child() const { return this[far]; }
};

struct KdNodes {
  std::vector<std::int32_t> order;  // indices of points
  std::vector<KdNode> nodes;        // root first, parents before children; empty without points
  Vec3 low, high;                   // corners of the box of all points
};

// Tree over the points with these indices. Coordinates must be finite.
KdNodes kd_nodes(std::span<const Vec3> points, std::span<const std::int32_t> indices);

}  // namespace salbench
