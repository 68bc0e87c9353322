// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/roc.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace salbench {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

// The picks of one value.
struct PickGroup {
  double value;
  double picks;     // with multiplicity
  double distinct;  // points
};

// By ascending value.
std::vector<PickGroup> groups_of(std::span<const double> map, std::span<const std::int32_t> picked) {
  std::vector<PickGroup> points;
  for (std::size_t k = 0; k < picked.size(); ++k) {
    if (k > 0 && picked[k] == picked[k - 1])
      ++points.back().picks;
    else
      points.push_back({map[static_cast<std::size_t>(picked[k])], 1, 1});
  }
  std::ranges::sort(points, {}, &PickGroup::value);
  std::vector<PickGroup> groups;
  for (const PickGroup& point : points) {
    if (groups.empty() || groups.back().value != point.value) {
      groups.push_back(point);
      continue;
    }
    groups.back().picks += point.picks;
    groups.back().distinct += point.distinct;
  }
  return groups;
}

double distinct_in(const std::vector<PickGroup>& groups) {
  double distinct = 0;
  for (const PickGroup& group : groups) distinct += group.distinct;
  return distinct;
}

}  // namespace

double auc_exact(std::span<const double> map, std::span<const std::int32_t> picked, Weighting weighting,
                 const Comparison& comparison) {
  const Distribution& all = comparison.map_distribution(weighting);
  double wins = 0;
  for (const std::int32_t i : picked) wins += all.mid[static_cast<std::size_t>(i)];
  double negatives = comparison.measure(weighting).total;
  if (weighting == Weighting::vertex) {
    // Without the wins over points that were picked themselves.
    double below = 0;
    for (const PickGroup& group : groups_of(map, picked)) {
      wins -= group.picks * (below + group.distinct / 2);
      below += group.distinct;
    }
    negatives -= below;
  }
  if (picked.empty() || !(negatives > 0)) return kUndefined;
  return wins / (static_cast<double>(picked.size()) * negatives);
}

double auc_judd(std::span<const double> map, std::span<const std::int32_t> picked, Weighting weighting,
                const Comparison& comparison) {
  const Distribution& all = comparison.map_distribution(weighting);
  const std::vector<PickGroup> groups = groups_of(map, picked);
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
    const double at_least = total - all.weight_below(group->value);
    advance(reached / static_cast<double>(picked.size()),
            (per_vertex ? at_least - reached_points : at_least) / negatives);
  }
  advance(1, 1);
  return area;
}

}  // namespace salbench
