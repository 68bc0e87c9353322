// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/cs_cells.h"

#include <algorithm>
#include <cmath>

#include "stages/core/check.h"
#include "stages/core/field.h"

namespace salbench {

OccupiedCells::OccupiedCells(std::span<const Vec3> points, double leaf) : leaf_(leaf) {
  CHECK_GT(leaf, 0.0);
  cells_.reserve(points.size());
  for (const Vec3& p : points) cells_.push_back(cell_of(p));
  sort_and_deduplicate(cells_);
}

OccupiedCells::Cell OccupiedCells::cell_of(const Vec3& point) const {
  return {std::floor(point.z() / leaf_), std::floor(point.y() / leaf_), std::floor(point.x() / leaf_)};
}

std::int32_t OccupiedCells::find(const Vec3& point) const {
  const Cell cell = cell_of(point);
  const auto at = std::ranges::lower_bound(cells_, cell);
  return at != cells_.end() && *at == cell ? static_cast<std::int32_t>(at - cells_.begin()) : kEmpty;
}

std::vector<std::int32_t> OccupiedCells::find(std::span<const Vec3> points) const {
  std::vector<std::int32_t> found;
  found.reserve(points.size());
  for (const Vec3& p : points) found.push_back(find(p));
  return found;
}

}  // namespace salbench
