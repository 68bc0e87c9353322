// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/distribution.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "stages/core/check.h"

namespace salbench {

Order ascending_order(std::span<const double> field) {
  CHECK_EQ(std::ranges::none_of(field, [](double value) { return std::isnan(value); }), true);
  Order order(field.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return field[i]; });
  return order;
}

Distribution distribution(std::span<const double> field, const Order& order, const Measure& measure) {
  const std::size_t n = field.size();
  CHECK_EQ(order.size(), n);
  CHECK_EQ(measure.size(), n);
  Distribution result{ScalarField(n), {}, {}};
  double weight = 0;
  for (std::size_t first = 0, end = 0; first < n; first = end) {
    const double value = field[order[first]], below = weight;
    do {
      weight += measure.weight[order[end]];
      result.values.push_back(value);
      result.reached.push_back(weight);
    } while (++end < n && field[order[end]] == value);
    for (std::size_t k = first; k < end; ++k) result.mid[order[k]] = below + (weight - below) / 2;
  }
  return result;
}

double Distribution::weight_below(double value) const {
  const auto points = std::ranges::lower_bound(values, value) - values.begin();
  return points == 0 ? 0 : reached[static_cast<std::size_t>(points) - 1];
}

double Distribution::quantile(double u) const {
  const auto at = std::ranges::upper_bound(reached, u * total());
  return at == reached.end() ? values.back() : values[static_cast<std::size_t>(at - reached.begin())];
}

}  // namespace salbench
