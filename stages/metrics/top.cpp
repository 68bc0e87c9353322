// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/top.h"

#include <cstddef>

namespace salbench {

TopScore top_score(const TopInput& in, int percent, const Measure& measure) {
  if (is_constant(in.saliency, measure)) return {};
  const auto value = [&](std::size_t k) { return in.saliency[in.saliency_order[k]]; };
  std::size_t above =
      0;  // points of the order from here on lie above the minimum of those that have a weight
  while (!(measure.weight[in.saliency_order[above]] > 0)) ++above;
  const double minimum = value(above);
  while (value(above) <= minimum) ++above;
  // Sums of areas are rounded: equal parts must not differ by that.
  const double part = percent / 100.0 * measure.total * (1 - 1e-9);
  double weight = 0, mid = 0, height = 0;  // sums from the top down; equal values come together
  for (std::size_t next = in.saliency_order.size(); next > above && weight < part;) {
    const double shared = value(next - 1);
    do {
      const std::size_t i = in.saliency_order[--next];
      weight += measure.weight[i];
      mid += measure.weight[i] * in.map_distribution.mid[i];
      height += measure.weight[i] * (in.map[i] - in.map_moments.mean);
    } while (next > above && value(next - 1) == shared);
  }
  // Over all points, of which weight^2 / 2 falls to pairs on top: each has one win, and each point a tie with
  // itself.
  return {(mid - weight * weight / 2) / (weight * (measure.total - weight)),
          height / (weight * in.map_moments.deviation)};
}

}  // namespace salbench
