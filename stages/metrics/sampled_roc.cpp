// SPDX-License-Identifier: GPL-3.0-or-later
// Each value is compared with each threshold: some hundred values and twenty thresholds are fewer operations
// than a sort, and compilers use vectors for them.
#include "stages/metrics/sampled_roc.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace salbench {
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

// Distribution::quantile of many numbers, a thousandth of the points searched for each.
class Quantiles {
 public:
  explicit Quantiles(const Distribution& map) : map_(map) {
    for (std::size_t cell = 0; cell <= kCells; ++cell)
      first_.push_back(
          std::ranges::upper_bound(map.reached, static_cast<double>(cell) / kCells * map.total()));
  }
  double operator()(double u) const {
    const auto cell = static_cast<std::size_t>(u * kCells);
    const auto at = std::upper_bound(first_[cell], first_[cell + 1], u * map_.total());
    return map_.values[static_cast<std::size_t>(std::min(at, map_.reached.end() - 1) - map_.reached.begin())];
  }

 private:
  static constexpr std::size_t kCells = 1024;
  const Distribution& map_;
  std::vector<std::vector<double>::const_iterator> first_;  // [cell]: what may be the quantile of its numbers
};

}  // namespace

RandomValues::RandomValues(std::span<const double> map, Rng rng) {
  if (map.size() >= 2) next_ = [map, rng]() mutable { return map[rng.below(map.size() - 1) + 1]; };
}

RandomValues::RandomValues(const Distribution& map, Rng rng) {
  if (map.total() > 0) next_ = [of = Quantiles(map), rng]() mutable { return of(rng.uniform()); };
}

std::span<const double> RandomValues::first(std::size_t count) {
  while (values_.size() < count) values_.push_back(next_());
  return std::span(values_).first(count);
}

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

}  // namespace salbench
