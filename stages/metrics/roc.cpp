// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/roc.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include "stages/core/check.h"
#include "stages/core/field.h"

namespace salbench {

ScalarField pick_counts(std::span<const std::int32_t> picked, std::size_t n) {
  ScalarField counts(n, 0);
  for (const std::int32_t i : picked) ++counts[index(i)];
  return counts;
}

ScalarField all_others(std::span<const double> weights) {
  ScalarField others;
  others.reserve(weights.size());
  for (const double weight : weights) others.push_back(weight > 0 ? 0 : 1);
  return others;
}

ScalarField upper_fifth(std::span<const double> field, const Order& order) {
  ScalarField top(field.size(), 0);
  const auto value = [&](std::size_t k) { return field[order[k]]; };
  // Tolerates rounding of the product: equal shares must be treated alike.
  const double share = 0.2 * static_cast<double>(field.size()) * (1 - 1e-9);
  for (std::size_t end = order.size(); end > 0 && static_cast<double>(order.size() - end) < share;) {
    const double shared = value(end - 1);
    if (shared == value(0)) break;
    do top[order[--end]] = 1;
    while (end > 0 && value(end - 1) == shared);
  }
  return top;
}

double mann_whitney(std::span<const double> field, const Order& order, std::span<const double> positives,
                    std::span<const double> negatives) {
  CHECK_EQ(positives.size(), field.size());
  const MidRanks ranks = mid_ranks(field, order, negatives);
  double wins = 0, total = 0;
  for (std::size_t i = 0; i < field.size(); ++i) {
    wins += positives[i] * ranks.below[i];
    total += positives[i];
  }
  return total > 0 && ranks.total > 0 ? wins / (total * ranks.total) : kUndefined;
}

double auc_judd(std::span<const double> map, const Order& order, std::span<const double> positives) {
  const double all_picks = std::accumulate(positives.begin(), positives.end(), 0.0);
  const auto picked_points = std::ranges::count_if(positives, [](double picks) { return picks > 0; });
  const auto negatives = static_cast<double>(std::ssize(map) - picked_points);
  if (picked_points == 0 || !(negatives > 0)) return kUndefined;
  double area = 0, true_rate = 0, false_rate = 0, picks = 0, points = 0;  // reached so far
  const auto advance = [&](double next_true_rate, double next_false_rate) {
    area += (next_false_rate - false_rate) * (true_rate + next_true_rate) / 2;
    true_rate = next_true_rate;
    false_rate = next_false_rate;
  };
  for (std::size_t end = order.size(); end > 0;) {
    const double value = map[order[end - 1]], before = picks;
    do {
      const double here = positives[order[--end]];
      picks += here;
      points += here > 0 ? 1 : 0;
    } while (end > 0 && map[order[end - 1]] == value);
    const auto reached = static_cast<double>(order.size() - end);
    if (picks > before) advance(picks / all_picks, (reached - points) / negatives);
  }
  advance(1, 1);
  return area;
}

// --- random negatives. Each value is compared with each threshold: for some hundred values and twenty
// thresholds, that takes fewer operations than a sort, and compilers vectorise it.

namespace {

// [threshold]: fraction of the values at or above it.
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
  thresholds.push_back(largest);  // exact: rounding must not raise it above the values
  return thresholds;
}

}  // namespace

std::span<const double> RandomValues::first(std::size_t count) {
  while (values_.size() < count) values_.push_back(next_());
  return std::span(values_).first(count);
}

RandomValues values_at_random_points(std::span<const double> map, Rng rng) {
  if (map.size() < 2) return RandomValues(nullptr);
  return RandomValues([map, rng]() mutable { return map[rng.below(map.size() - 1) + 1]; });
}

RandomValues random_quantiles(std::vector<double> sorted, Rng rng) {
  if (sorted.empty()) return RandomValues(nullptr);
  return RandomValues([sorted = std::move(sorted), rng]() mutable {
    const auto at = static_cast<std::size_t>(rng.uniform() * static_cast<double>(sorted.size()));
    return sorted[std::min(at, sorted.size() - 1)];  // the product may be rounded up
  });
}

std::vector<double> tenths_of_range(std::span<const double> map) {
  if (map.empty()) return {};
  constexpr int kSteps = 10;
  const auto [lowest, highest] = std::ranges::minmax(map);
  std::vector<double> thresholds;
  for (int step = 0; step <= kSteps; ++step)
    thresholds.push_back(lowest + (highest - lowest) * step / kSteps);
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
    if (thresholds.empty() && (used.empty() || used.back() != largest)) {  // equal for most splits
      used = even_thresholds(splits.thresholds, largest);
      true_rates = rates(picks, used);
    }
    sum += area(true_rates, rates(of_split, used));
  }
  return sum / splits.count;
}

}  // namespace salbench
