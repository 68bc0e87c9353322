// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/measure.h"

#include <numeric>
#include <optional>

#include "stages/core/check.h"

namespace salbench {

Measure vertex_measure(std::size_t n) { return {std::vector<double>(n, 1.0), static_cast<double>(n), 1}; }

Measure area_measure(std::span<const double> areas) {
  const double total = std::accumulate(areas.begin(), areas.end(), 0.0);
  return {{areas.begin(), areas.end()}, total, total};
}

bool is_constant(std::span<const double> field, const Measure& measure) {
  CHECK_EQ(field.size(), measure.size());
  std::optional<double> first;
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (!(measure.weight[i] > 0)) continue;
    if (!first) first = field[i];
    if (field[i] != *first) return false;
  }
  return true;
}

}  // namespace salbench
