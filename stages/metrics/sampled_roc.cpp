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

std::vector<double> tenths_of_range(const Distribution& map) {
  constexpr int kSteps = 10;
  const double lowest = map.values.front(), range = map.values.back() - lowest;
  std::vector<double> thresholds;
  for (int step = 0; step <= kSteps; ++step) thresholds.push_back(lowest + range * step / kSteps);
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

// negative(): the value of the next draw. Without thresholds, each split has even ones of its own.
template <class Negative>
double mean_area(std::span<const double> picks, const std::vector<double>& thresholds, const Splits& splits,
                 const Negative& negative) {
  std::vector<double> negatives(picks.size());
  double sum = 0;
  for (std::int32_t split = 0; split < splits.count; ++split) {
    std::ranges::generate(negatives, negative);
    const double largest = std::max(std::ranges::max(picks), std::ranges::max(negatives));
    const std::vector<double> own =
        thresholds.empty() ? even_thresholds(splits.thresholds, largest) : thresholds;
    sum += area(rates(picks, own), rates(negatives, own));
  }
  return sum / splits.count;
}

}  // namespace

double sampled_auc(std::span<const double> map, std::span<const double> picks, const Splits& splits,
                   Rng rng) {
  if (picks.empty() || map.size() < 2) return kUndefined;
  return mean_area(picks, {}, splits, [&] { return map[rng.below(map.size() - 1) + 1]; });
}

double quantile_auc(const Distribution& map, std::span<const double> picks, Thresholds thresholds,
                    const Splits& splits, Rng rng) {
  if (picks.empty() || !(map.total() > 0)) return kUndefined;
  const std::vector<double> fixed =
      thresholds == Thresholds::tenths ? tenths_of_range(map) : std::vector<double>{};
  return mean_area(picks, fixed, splits, [&, quantile = Quantiles(map)] { return quantile(rng.uniform()); });
}

}  // namespace salbench
