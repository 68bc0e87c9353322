// SPDX-License-Identifier: GPL-3.0-or-later
// Neighbours of each point of a shape, by a radius or by number, as the histograms read them.
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

// Nearest points that fit into memory are kept, since they are read twice: for the votes and for the sums.
// Points and tree outlive it.
class Neighbourhoods {
 public:
  using Memory = std::vector<Neighbour>;  // of one thread; reused from point to point

  Neighbourhoods(Points points, const KdTree& tree, const Support& support);

  bool all_points() const { return tree_.size() == points_.size(); }
  // True if i is a neighbour of j whenever j is one of i.
  bool mutual() const { return k_ == 0 && all_points(); }
  double radius() const { return support_.radius; }

  // By (distance, index); valid until `memory` is used again. The point itself is among them if the tree
  // contains it.
  std::span<const Neighbour> of(std::int32_t i, Memory& memory) const;
  std::span<const Neighbour> unordered(std::int32_t i, Memory& memory) const;

  // Number of the neighbours of i that are other points.
  std::size_t others(std::int32_t i, std::span<const Neighbour> neighbours) const {
    return neighbours.size() - (tree_.contains(i) ? 1 : 0);
  }

 private:
  std::size_t k_of(std::int32_t i) const;

  Points points_;
  const KdTree& tree_;
  Support support_;
  std::size_t k_ = 0;  // 0: a radius
  std::optional<NearestPoints> nearest_;
};

}  // namespace salbench
