// SPDX-License-Identifier: GPL-3.0-or-later
// Neighbours of each point of a shape, by radius or by number, for the histograms.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stages/core/types.h"
#include "stages/descriptors/fpfh.h"
#include "stages/geometry/neighbours.h"

namespace salbench {

// Nearest points are kept if they fit into memory, since they are read twice: for votes and for sums. Keeps
// references to points and tree.
class Neighbourhoods {
 public:
  using Memory = std::vector<Neighbour>;  // per thread; reused between points

  Neighbourhoods(Points points, const KdTree& tree, const Support& support);

  bool all_points() const { return tree_.size() == points_.size(); }
  // True if neighbourhood is symmetric.
  bool mutual() const { return k_ == 0 && all_points(); }
  double radius() const { return support_.radius; }

  // Sorted by (distance, index); valid until `memory` is reused. Contains the point itself if the tree does.
  std::span<const Neighbour> of(std::int32_t i, Memory& memory) const;
  std::span<const Neighbour> unordered(std::int32_t i, Memory& memory) const;

  // Number of neighbours of i without i itself.
  std::size_t others(std::int32_t i, std::span<const Neighbour> neighbours) const {
    return neighbours.size() - (tree_.contains(i) ? 1 : 0);
  }

 private:
  std::size_t k_of(std::int32_t i) const;

  Points points_;
  const KdTree& tree_;
  Support support_;
  std::size_t k_ = 0;  // 0: by radius
  std::optional<NearestPoints> nearest_;
};

}  // namespace salbench
