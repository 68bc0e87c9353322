// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/shuffled_roc.h"

#include "stages/core/check.h"
#include "stages/core/field.h"
#include "stages/metrics/distribution.h"

namespace salbench {

double shuffled_auc(std::span<const double> map, std::span<const std::int32_t> picked,
                    std::span<const double> negatives, const Measure& measure) {
  if (picked.empty() || negatives.empty()) return kUndefined;
  CHECK_EQ(negatives.size(), map.size());
  const double scale = scale_to_ordinary(negatives);
  const Order order = ascending_order(map);
  ScalarField below(map.size());  // by point: negatives of a smaller value, and half of those of an equal one
  double total = 0;
  for (std::size_t first = 0, end = 0; first < order.size(); first = end) {
    double equal = 0;
    for (; end < order.size() && map[order[end]] == map[order[first]]; ++end)
      equal += negatives[order[end]] * scale * measure.weight[order[end]];
    for (std::size_t k = first; k < end; ++k) below[order[k]] = total + equal / 2;
    total += equal;
  }
  if (!(total > 0)) return kUndefined;
  double wins = 0;
  for (const std::int32_t i : picked) wins += below[index(i)];
  return wins / (static_cast<double>(picked.size()) * total);
}

}  // namespace salbench
