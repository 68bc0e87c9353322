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

// How many of some ascending positions in [0, 1] a number has reached, looked up in equal cells: most have
// none.
class Reached {
 public:
  explicit Reached(std::vector<double> from) : from_(std::move(from)) {
    std::uint32_t reached = 0;
    for (std::size_t cell = 0; cell < kCells; ++cell)
      first_[cell] = reached = advanced(reached, static_cast<double>(cell) / kCells);
  }
  std::size_t operator()(double u) const {
    return advanced(first_[std::min(static_cast<std::size_t>(u * kCells), kCells - 1)], u);
  }

 private:
  static constexpr std::size_t kCells = 256;

  std::uint32_t advanced(std::uint32_t reached, double u) const {
    while (reached < from_.size() && from_[reached] <= u) ++reached;
    return reached;
  }

  std::vector<double> from_;
  std::array<std::uint32_t, kCells> first_{};
};

// Part of the weight that lies below each threshold.
std::vector<double> parts_below(const Distribution& map, const std::vector<double>& thresholds) {
  std::vector<double> parts;
  for (const double threshold : thresholds) parts.push_back(map.weight_below(threshold) / map.total());
  return parts;
}

// Rng::below for one bound, the same numbers without its two divisions per draw.
class Below {
 public:
  explicit Below(std::uint64_t bound)
      : bound_(bound), reject_below_((0 - bound) % bound), inverse_(~std::uint64_t{0} / bound) {}
  std::uint64_t operator()(Rng& rng) const {
    std::uint64_t draw = rng.next();
    while (draw < reject_below_) draw = rng.next();
    // The quotient is one or two too small at most.
    __extension__ using Wide = unsigned __int128;
    std::uint64_t rest = draw - static_cast<std::uint64_t>((Wide{draw} * inverse_) >> 64U) * bound_;
    while (rest >= bound_) rest -= bound_;
    return rest;
  }

 private:
  std::uint64_t bound_, reject_below_, inverse_;
};

// The curve of one set of picks, split by split.
class Curve {
 public:
  Curve(std::span<const double> picks, std::int32_t splits)
      : positives_(picks.begin(), picks.end()), splits_(splits) {
    std::ranges::sort(positives_);
  }

  std::size_t size() const { return positives_.size(); }
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
std::size_t even_reached(double value, const std::vector<double>& thresholds, double per_unit) {
  // Where the quotient is rounded to the wrong side, the threshold decides.
  auto reached = static_cast<std::size_t>(value * per_unit) + 1;
  while (reached < thresholds.size() && thresholds[reached] <= value) ++reached;
  while (reached > thresholds.size() || (reached > 0 && thresholds[reached - 1] > value)) --reached;
  return reached;
}

}  // namespace

double sampled_auc(std::span<const double> map, std::span<const double> picks, const Splits& splits,
                   Rng rng) {
  if (picks.empty() || map.size() < 2) return kUndefined;
  Curve curve(picks, splits.count);
  const Below below(map.size() - 1);
  std::vector<double> thresholds, negatives(curve.size());
  double up_to = kUndefined;  // of the thresholds
  for (std::int32_t split = 0; split < splits.count; ++split) {
    double largest = curve.largest(), lowest = 0;
    for (double& value : negatives) {
      value = map[1 + below(rng)];
      largest = std::max(largest, value);
      lowest = std::min(lowest, value);
    }
    if (largest != up_to) {
      thresholds = even_thresholds(splits.thresholds, up_to = largest);
      curve.set_thresholds(thresholds);
    }
    if (!(largest > 0) || lowest < 0) {  // no map that was matched, but a constant one may be
      curve.end_split(negatives, thresholds);
      continue;
    }
    const double per_unit = (splits.thresholds - 1) / largest;
    for (const double value : negatives) curve.add_negative(even_reached(value, thresholds, per_unit));
    curve.end_split();
  }
  return curve.mean();
}

double sampled_auc(const Distribution& map, std::span<const double> picks, const Splits& splits, Rng rng) {
  if (picks.empty() || !(map.total() > 0)) return kUndefined;
  Curve curve(picks, splits.count);
  std::vector<double> thresholds, draws(curve.size());
  std::optional<Reached> reached;
  double up_to = kUndefined;  // of the thresholds
  for (std::int32_t split = 0; split < splits.count; ++split) {
    double last = 0;
    for (double& u : draws) last = std::max(last, u = rng.uniform());
    const double largest = std::max(curve.largest(), map.quantile(last));
    if (largest != up_to) {
      thresholds = even_thresholds(splits.thresholds, up_to = largest);
      curve.set_thresholds(thresholds);
      reached.emplace(parts_below(map, thresholds));
    }
    if (!(largest > 0)) {
      for (double& u : draws) u = map.quantile(u);
      curve.end_split(draws, thresholds);
      continue;
    }
    for (const double u : draws) curve.add_negative((*reached)(u));
    curve.end_split();
  }
  return curve.mean();
}

double sampled_auc_borji(const Distribution& map, std::span<const double> picks, std::int32_t splits,
                         Rng rng) {
  if (picks.empty() || !(map.total() > 0)) return kUndefined;
  constexpr int kSteps = 10;
  const double lowest = map.values.front(), range = map.values.back() - lowest;
  std::vector<double> thresholds;
  for (int step = 0; step <= kSteps; ++step) thresholds.push_back(lowest + range * step / kSteps);
  Curve curve(picks, splits);
  curve.set_thresholds(thresholds);
  const Reached reached(parts_below(map, thresholds));
  for (std::int32_t split = 0; split < splits; ++split) {
    for (std::size_t k = 0; k < curve.size(); ++k) curve.add_negative(reached(rng.uniform()));
    curve.end_split();
  }
  return curve.mean();
}

}  // namespace salbench
