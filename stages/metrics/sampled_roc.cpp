// SPDX-License-Identifier: GPL-3.0-or-later
// Values are counted between thresholds and never sorted: a split is a pass over its draws.
#include "stages/metrics/sampled_roc.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace salbench {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

using Counts = std::vector<std::uint32_t>;  // [number of thresholds reached]: values, 0..thresholds

// Ascending if `largest` is >= 0.
std::vector<double> even_thresholds(std::int32_t count, double largest) {
  std::vector<double> thresholds;
  for (std::int32_t t = 0; t + 1 < count; ++t) thresholds.push_back(largest * t / (count - 1));
  thresholds.push_back(largest);  // itself: rounding must not lift it above
  return thresholds;
}

// [threshold]: fraction of the counted values that reach it.
void rates(const Counts& counts, std::size_t total, std::vector<double>& result) {
  std::size_t reached = 0;
  for (std::size_t t = counts.size() - 1; t-- > 0;) {
    reached += counts[t + 1];
    result[t] = static_cast<double>(reached) / static_cast<double>(total);
  }
}

// [threshold]: fraction of the ascending values that reach it. Thresholds need not ascend: those up to a
// negative largest value do not.
std::vector<double> rates_of(const std::vector<double>& values, const std::vector<double>& thresholds) {
  std::vector<double> result;
  for (const double threshold : thresholds)
    result.push_back(static_cast<double>(values.end() - std::ranges::lower_bound(values, threshold)) /
                     static_cast<double>(values.size()));
  return result;
}

double area_under_curve(const std::vector<double>& true_rates, const std::vector<double>& false_rates) {
  double area = 0;
  double true_rate = 1, false_rate = 1;
  const auto advance = [&](double next_true_rate, double next_false_rate) {
    area += (false_rate - next_false_rate) * (true_rate + next_true_rate) / 2;
    true_rate = next_true_rate;
    false_rate = next_false_rate;
  };
  for (std::size_t t = 0; t < true_rates.size(); ++t) advance(true_rates[t], false_rates[t]);
  advance(0, 0);
  return area;
}

// How many of some ascending positions in [0, 1] a number in [0, 1) has reached, looked up in equal cells:
// most of them have no position within.
class Reached {
 public:
  explicit Reached(std::vector<double> from) : from_(std::move(from)) {
    std::int32_t reached = 0;
    for (std::size_t cell = 0; cell < kCells; ++cell) {
      const std::int32_t before = reached = advanced(reached, static_cast<double>(cell) / kCells);
      const std::int32_t behind = advanced(before, static_cast<double>(cell + 1) / kCells);
      in_cell_[cell] = behind == before ? before : -1 - before;
    }
  }

  std::size_t operator()(double u) const {
    const std::int32_t known = in_cell_[static_cast<std::size_t>(u * kCells)];
    return static_cast<std::size_t>(known >= 0 ? known : advanced(-1 - known, u));
  }

 private:
  static constexpr std::size_t kCells = 128;  // a power of two: u * kCells stays below it

  std::int32_t advanced(std::int32_t reached, double u) const {
    while (static_cast<std::size_t>(reached) < from_.size() && from_[static_cast<std::size_t>(reached)] <= u)
      ++reached;
    return reached;
  }

  std::vector<double> from_;
  std::array<std::int32_t, kCells> in_cell_{};  // -1 - the number at its beginning where it has one within
};

// Part of the weight that lies below each threshold.
std::vector<double> parts_below(const Distribution& map, const std::vector<double>& thresholds) {
  std::vector<double> parts;
  for (const double threshold : thresholds) parts.push_back(map.weight_below(threshold) / map.total());
  return parts;
}

// The curve of one set of picks, split by split.
class Curve {
 public:
  Curve(std::span<const double> picks, std::int32_t splits)
      : positives_(picks.begin(), picks.end()), splits_(splits) {
    std::ranges::sort(positives_);
  }

  double largest() const { return positives_.back(); }

  void set_thresholds(const std::vector<double>& thresholds) {
    true_rates_ = rates_of(positives_, thresholds);
    false_rates_.resize(thresholds.size());
    counts_.assign(thresholds.size() + 1, 0);
  }
  void add_negative(std::size_t thresholds_reached) { ++counts_[thresholds_reached]; }
  void end_split() {
    rates(counts_, positives_.size(), false_rates_);
    sum_ += area_under_curve(true_rates_, false_rates_);
    std::ranges::fill(counts_, 0);
  }
  void end_split(std::vector<double> negatives, const std::vector<double>& thresholds) {
    std::ranges::sort(negatives);
    sum_ += area_under_curve(rates_of(positives_, thresholds), rates_of(negatives, thresholds));
  }
  double mean() const { return sum_ / splits_; }

 private:
  std::vector<double> positives_;  // ascending
  std::int32_t splits_;
  std::vector<double> true_rates_, false_rates_;
  Counts counts_;
  double sum_ = 0;
};

// How many even thresholds up to `largest` > 0 a value from 0 to `largest` reaches.
class EvenReached {
 public:
  EvenReached(std::vector<double> thresholds, double largest)
      : per_unit_(static_cast<double>(thresholds.size() - 1) / largest), thresholds_(std::move(thresholds)) {
    thresholds_.push_back(std::numeric_limits<double>::infinity());
  }

  std::size_t operator()(double value) const {
    auto reached = static_cast<std::size_t>(value * per_unit_) + 1;
    reached = std::min(reached, thresholds_.size() - 1);
    // Where the product is rounded to the wrong side, the threshold decides. The first one is 0, the last
    // infinite.
    while (thresholds_[reached] <= value) ++reached;
    while (thresholds_[reached - 1] > value) --reached;
    return reached;
  }

 private:
  double per_unit_;
  std::vector<double> thresholds_;
};

}  // namespace

double sampled_auc(std::span<const double> picks, ValueDraws& draws, const Splits& splits) {
  if (picks.empty()) return kUndefined;
  Curve curve(picks, splits.count);
  std::span<const double> rest = draws.first(static_cast<std::size_t>(splits.count) * picks.size());
  std::vector<double> thresholds;
  double up_to = kUndefined;  // of the thresholds
  for (; !rest.empty(); rest = rest.subspan(picks.size())) {
    const auto negatives = rest.first(picks.size());
    const auto [smallest, largest_negative] = std::ranges::minmax(negatives);
    const double largest = std::max(curve.largest(), largest_negative);
    if (largest != up_to) {
      thresholds = even_thresholds(splits.thresholds, up_to = largest);
      curve.set_thresholds(thresholds);
    }
    if (!(largest > 0) || smallest < 0) {  // no map that was matched, but a constant one may be
      curve.end_split({negatives.begin(), negatives.end()}, thresholds);
      continue;
    }
    const EvenReached reached(thresholds, largest);
    for (const double value : negatives) curve.add_negative(reached(value));
    curve.end_split();
  }
  return curve.mean();
}

double sampled_auc(const Distribution& map, std::span<const double> picks, UniformDraws& draws,
                   const Splits& splits) {
  if (picks.empty() || !(map.total() > 0)) return kUndefined;
  Curve curve(picks, splits.count);
  std::span<const double> rest = draws.first(static_cast<std::size_t>(splits.count) * picks.size());
  std::vector<double> thresholds;
  std::optional<Reached> reached;
  double up_to = kUndefined;  // of the thresholds
  for (; !rest.empty(); rest = rest.subspan(picks.size())) {
    const auto negatives = rest.first(picks.size());
    const double largest = std::max(curve.largest(), map.quantile(std::ranges::max(negatives)));
    if (largest != up_to) {
      thresholds = even_thresholds(splits.thresholds, up_to = largest);
      curve.set_thresholds(thresholds);
      reached.emplace(parts_below(map, thresholds));
    }
    if (!(largest > 0)) {
      std::vector<double> values;
      for (const double u : negatives) values.push_back(map.quantile(u));
      curve.end_split(values, thresholds);
      continue;
    }
    for (const double u : negatives) curve.add_negative((*reached)(u));
    curve.end_split();
  }
  return curve.mean();
}

double sampled_auc_borji(const Distribution& map, std::span<const double> picks, UniformDraws& draws,
                         std::int32_t splits) {
  if (picks.empty() || !(map.total() > 0)) return kUndefined;
  constexpr int kSteps = 10;
  const double lowest = map.values.front(), range = map.values.back() - lowest;
  std::vector<double> thresholds;
  for (int step = 0; step <= kSteps; ++step) thresholds.push_back(lowest + range * step / kSteps);
  Curve curve(picks, splits);
  curve.set_thresholds(thresholds);
  const Reached reached(parts_below(map, thresholds));
  std::span<const double> rest = draws.first(static_cast<std::size_t>(splits) * picks.size());
  for (; !rest.empty(); rest = rest.subspan(picks.size())) {
    for (const double u : rest.first(picks.size())) curve.add_negative(reached(u));
    curve.end_split();
  }
  return curve.mean();
}

}  // namespace salbench
