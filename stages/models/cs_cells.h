// SPDX-License-Identifier: GPL-3.0-or-later
// The occupied cells of a regular grid.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

// Cubes of side `leaf` > 0, aligned with the origin of coordinates whatever the extent of the points: cell
// (i, j, k) holds i leaf <= x < (i + 1) leaf, and so on. Cells that hold a point are numbered by k, then j,
// then i, as in PCL's VoxelGrid.
class OccupiedCells {
 public:
  OccupiedCells(std::span<const Vec3> points, double leaf);

  static constexpr std::int32_t kEmpty = -1;
  std::int32_t find(const Vec3& point) const;                          // kEmpty if the cell holds no point
  std::vector<std::int32_t> find(std::span<const Vec3> points) const;  // one per point
  std::size_t size() const { return cells_.size(); }

 private:
  using Cell = std::array<double, 3>;  // k, j, i: whole numbers, which are large far from the origin
  Cell cell_of(const Vec3& point) const;

  double leaf_;
  std::vector<Cell> cells_;  // ascending, each once
};

}  // namespace salbench
