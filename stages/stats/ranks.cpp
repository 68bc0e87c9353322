// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stats/ranks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "stages/core/check.h"

namespace salbench {

Ranks midranks(std::span<const double> values) {
  for (const double value : values) CHECK_EQ(std::isnan(value), false);
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });

  Ranks result{std::vector<double>(values.size()), 0};
  for (std::size_t first = 0, end = 0; first < order.size(); first = end) {
    do ++end;
    while (end < order.size() && values[order[end]] == values[order[first]]);
    const double shared = static_cast<double>(first + 1 + end) / 2;  // mean of the ranks first + 1 .. end
    for (std::size_t k = first; k < end; ++k) result.rank[order[k]] = shared;
    const auto t = static_cast<double>(end - first);
    result.ties += t * t * t - t;
  }
  return result;
}

}  // namespace salbench
