// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/roc.h"

#include <vector>

#include "stages/metrics/picks.h"

namespace salbench {
namespace {

double distinct_in(const std::vector<PickGroup>& groups) {
  double distinct = 0;
  for (const PickGroup& group : groups) distinct += group.distinct;
  return distinct;
}

}  // namespace

double auc_of_all(std::span<const std::int32_t> picked, Weighting weighting, const Comparison& comparison) {
  const Distribution& all = comparison.map_distribution(weighting);
  if (picked.empty() || !(all.total() > 0)) return kUndefined;
  double wins = 0;
  for (const std::int32_t i : picked) wins += all.mid[static_cast<std::size_t>(i)];
  return wins / (static_cast<double>(picked.size()) * comparison.measure(weighting).total);
}

double auc_exact(std::span<const double> map, std::span<const std::int32_t> picked) {
  double wins = 0, picked_below = 0;
  for (const PickGroup& group : pick_groups(map, picked)) {
    wins += group.picks * (group.below - picked_below + (group.equal - group.distinct) / 2);
    picked_below += group.distinct;
  }
  const double negatives = static_cast<double>(map.size()) - picked_below;
  if (picked.empty() || !(negatives > 0)) return kUndefined;
  return wins / (static_cast<double>(picked.size()) * negatives);
}

double auc_exact(std::span<const std::int32_t> picked, Weighting weighting, const Comparison& comparison) {
  return weighting == Weighting::area ? auc_of_all(picked, weighting, comparison)
                                      : auc_exact(comparison.of.map, picked);
}

double auc_judd(std::span<const std::int32_t> picked, Weighting weighting, const Comparison& comparison) {
  const std::vector<PickGroup> groups = pick_groups(comparison.of.map, picked);
  const bool per_vertex = weighting == Weighting::vertex;
  const double total = comparison.measure(weighting).total;
  const double negatives = per_vertex ? total - distinct_in(groups) : total;
  if (picked.empty() || !(negatives > 0)) return kUndefined;
  double area = 0, true_rate = 0, false_rate = 0, reached = 0, reached_points = 0;
  const auto advance = [&](double next_true_rate, double next_false_rate) {
    area += (next_false_rate - false_rate) * (true_rate + next_true_rate) / 2;
    true_rate = next_true_rate;
    false_rate = next_false_rate;
  };
  for (auto group = groups.rbegin(); group != groups.rend(); ++group) {
    reached += group->picks;
    reached_points += group->distinct;
    const double below =
        per_vertex ? group->below : comparison.map_distribution(weighting).weight_below(group->value);
    const double at_least = total - below;
    advance(reached / static_cast<double>(picked.size()),
            (per_vertex ? at_least - reached_points : at_least) / negatives);
  }
  advance(1, 1);
  return area;
}

}  // namespace salbench
