// SPDX-License-Identifier: GPL-3.0-or-later
// Occupied cells of a regular grid.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

// Cubes of side `leaf` > 0, aligned with the origin of coordinates, independent of the points' extent: cell
// (i, j, k) contains i leaf <= x < (i + 1) leaf, and so on. Occupied cells are numbered by k, then j, then i,
// as in PCL's VoxelGrid.
class OccupiedCells {
 public:
  OccupiedCells(std::span<const Vec3> points, double leaf);

  static constexpr std::int32_t kEmpty = -1;
  std::int32_t find(const Vec3& point) const;                          // kEmpty if the cell is not occupied
  std::vector<std::int32_t> find(std::span<const Vec3> points) const;  // one per point
  std::size_t size() const { return cells_.size(); }

 private:
  using Cell = std::array<double, 3>;  // k, j, i: integers, which are large far from the origin
  Cell cell_of(const Vec3& point) const;

  double leaf_;
  std::vector<Cell> cells_;  // ascending and distinct
};

}  // namespace salbench
