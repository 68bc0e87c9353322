// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/ranks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "stages/core/check.h"

namespace salbench {

// Values are sorted together with their points, which is faster than indirect access; those with the smallest
// value, often half of a shape, are not sorted.
Order ascending_order(std::span<const double> field) {
  CHECK_EQ(std::ranges::none_of(field, [](double value) { return std::isnan(value); }), true);
  struct Entry {
    double value;
    std::uint32_t point;
  };
  const double smallest = field.empty() ? 0 : std::ranges::min(field);
  Order order;
  order.reserve(field.size());
  std::vector<Entry> larger;
  larger.reserve(field.size());
  for (std::uint32_t i = 0; i < field.size(); ++i)
    if (field[i] == smallest)
      order.push_back(i);
    else
      larger.push_back({field[i], i});
  std::ranges::sort(larger, [](const Entry& a, const Entry& b) {
    return a.value != b.value ? a.value < b.value : a.point < b.point;
  });
  for (const Entry& entry : larger) order.push_back(entry.point);
  return order;
}

MidRanks mid_ranks(std::span<const double> field, const Order& order, std::span<const double> weights) {
  const std::size_t n = field.size();
  CHECK_EQ(order.size(), n);
  CHECK_EQ(weights.size(), n);
  MidRanks ranks{ScalarField(n)};
  for (std::size_t first = 0, end = 0; first < n; first = end) {
    double equal = 0;
    do {
      equal += weights[order[end]];
    } while (++end < n && field[order[end]] == field[order[first]]);
    for (std::size_t k = first; k < end; ++k) ranks.below[order[k]] = ranks.total + equal / 2;
    ranks.total += equal;
  }
  return ranks;
}

}  // namespace salbench
