// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/roc.h"

#include <algorithm>
#include <cstddef>
#include <ranges>
#include <vector>

#include "stages/core/check.h"
#include "stages/core/field.h"

namespace salbench {
namespace {

// The picks of one value.
struct PickGroup {
  double value;
  double picks;                 // with multiplicity
  double distinct;              // points
  double below = 0, equal = 0;  // points of the map with a smaller value, and with this one
};

// By ascending value. `picked` ascends.
std::vector<PickGroup> pick_groups(std::span<const double> map, std::span<const std::int32_t> picked) {
  std::vector<PickGroup> points;
  points.reserve(picked.size());
  for (std::size_t k = 0; k < picked.size(); ++k) {
    if (k > 0 && picked[k] == picked[k - 1])
      ++points.back().picks;
    else
      points.push_back({map[static_cast<std::size_t>(picked[k])], 1, 1});
  }
  std::ranges::sort(points, {}, &PickGroup::value);
  std::vector<PickGroup> groups;
  groups.reserve(points.size());
  for (const PickGroup& point : points) {
    if (groups.empty() || groups.back().value != point.value) {
      groups.push_back(point);
      continue;
    }
    groups.back().picks += point.picks;
    groups.back().distinct += point.distinct;
  }
  for (const double value : map) {
    const auto group = std::ranges::lower_bound(groups, value, {}, &PickGroup::value);
    if (group != groups.end()) ++(group->value == value ? group->equal : group->below);
  }
  double below = 0;
  for (PickGroup& group : groups) {
    group.below += below;
    below = group.below + group.equal;
  }
  return groups;
}

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
  for (const PickGroup& group : std::views::reverse(groups)) {
    reached += group.picks;
    reached_points += group.distinct;
    const double below =
        per_vertex ? group.below : comparison.map_distribution(weighting).weight_below(group.value);
    const double at_least = total - below;
    advance(reached / static_cast<double>(picked.size()),
            (per_vertex ? at_least - reached_points : at_least) / negatives);
  }
  advance(1, 1);
  return area;
}

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

// --- random negatives. Each value is compared with each threshold: some hundred values and twenty thresholds
// are fewer operations than a sort, and compilers use vectors for them.

namespace {

// [threshold]: fraction of the values that reach it.
std::vector<double> rates(std::span<const double> values, std::span<const double> thresholds) {
  std::vector<double> result;
  for (const double threshold : thresholds) {
    const auto reach = std::ranges::count_if(values, [&](double value) { return value >= threshold; });
    result.push_back(static_cast<double>(reach) / static_cast<double>(values.size()));
  }
  return result;
}

double area(std::span<const double> true_rates, std::span<const double> false_rates) {
  double area = 0, true_rate = 1, false_rate = 1;
  const auto advance = [&](double next_true_rate, double next_false_rate) {
    area += (false_rate - next_false_rate) * (true_rate + next_true_rate) / 2;
    true_rate = next_true_rate;
    false_rate = next_false_rate;
  };
  for (std::size_t k = 0; k < true_rates.size(); ++k) advance(true_rates[k], false_rates[k]);
  advance(0, 0);
  return area;
}

std::vector<double> even_thresholds(std::int32_t count, double largest) {
  std::vector<double> thresholds;
  for (std::int32_t k = 0; k + 1 < count; ++k) thresholds.push_back(largest * k / (count - 1));
  thresholds.push_back(largest);  // itself: rounding must not lift it above
  return thresholds;
}

}  // namespace

std::vector<double> tenths_of_range(const Distribution& map) {
  if (map.values.empty()) return {};
  constexpr int kSteps = 10;
  const double lowest = map.values.front(), range = map.values.back() - lowest;
  std::vector<double> thresholds;
  for (int step = 0; step <= kSteps; ++step) thresholds.push_back(lowest + range * step / kSteps);
  return thresholds;
}

double sampled_auc(std::span<const double> picks, RandomValues& negatives, const Splits& splits,
                   const std::vector<double>& thresholds) {
  if (picks.empty() || negatives.none()) return kUndefined;
  const std::span<const double> drawn =
      negatives.first(static_cast<std::size_t>(splits.count) * picks.size());
  const double largest_pick = std::ranges::max(picks);
  std::vector<double> used = thresholds, true_rates = rates(picks, used);
  double sum = 0;
  for (std::size_t first = 0; first < drawn.size(); first += picks.size()) {
    const std::span<const double> of_split = drawn.subspan(first, picks.size());
    const double largest = std::max(largest_pick, std::ranges::max(of_split));
    if (thresholds.empty() && (used.empty() || used.back() != largest)) {  // that of most splits is the same
      used = even_thresholds(splits.thresholds, largest);
      true_rates = rates(picks, used);
    }
    sum += area(true_rates, rates(of_split, used));
  }
  return sum / splits.count;
}

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
