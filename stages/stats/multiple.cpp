// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stats/multiple.h"

#include <algorithm>
#include <cmath>

namespace salbench {

std::vector<double> holm_adjusted(std::span<const double> p_values) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < p_values.size(); ++i)
    if (!std::isnan(p_values[i])) order.push_back(i);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return p_values[a] < p_values[b]; });

  std::vector<double> adjusted(p_values.begin(), p_values.end());
  double largest = 0;  // a hypothesis falls only if all with smaller p-values fell
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto still_standing = static_cast<double>(order.size() - k);
    largest = std::max(largest, std::min(1.0, still_standing * p_values[order[k]]));
    adjusted[order[k]] = largest;
  }
  return adjusted;
}

}  // namespace salbench
