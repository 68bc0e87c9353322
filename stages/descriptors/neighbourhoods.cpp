// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/descriptors/neighbourhoods.h"

#include <algorithm>

#include "stages/core/check.h"

namespace salbench {
namespace {

constexpr std::size_t kMaxKept = 1 << 20;  // 16 MB

}  // namespace

Neighbourhoods::Neighbourhoods(Points points, const KdTree& tree, const Support& support)
    : points_(points), tree_(tree), support_(support) {
  CHECK_LE(0, support.neighbours);
  k_ = std::min(static_cast<std::size_t>(support.neighbours), tree.size());
  if (k_ > 0 && points.size() * k_ <= kMaxKept) nearest_ = tree.nearest_of_each(points, k_);
}

std::span<const Neighbour> Neighbourhoods::of(std::int32_t i, Memory& memory) const {
  if (k_ > 0) {
    const std::size_t k = k_of(i);
    if (nearest_) return nearest_->of(index(i)).first(k);
    tree_.nearest(at(points_, i), k, memory);
  } else {
    tree_.within(at(points_, i), support_.radius, memory);
  }
  return memory;
}

std::span<const Neighbour> Neighbourhoods::unordered(std::int32_t i, Memory& memory) const {
  if (k_ > 0) return of(i, memory);
  tree_.within_unordered(at(points_, i), support_.radius, memory);
  return memory;
}

// A point counts among its own nearest, whether or not the tree contains it.
std::size_t Neighbourhoods::k_of(std::int32_t i) const {
  return tree_.contains(i) ? k_ : std::min(k_, static_cast<std::size_t>(support_.neighbours) - 1);
}

}  // namespace salbench
