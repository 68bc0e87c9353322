// SPDX-License-Identifier: GPL-3.0-or-later
// Values are counted between thresholds and never sorted: a split is a pass over its draws.
#include "stages/metrics/sampled_roc.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "stages/metrics/threshold_table.h"

namespace salbench {
namespace {

// The curve of one set of picks, split by split.
class Curve {
 public:
  Curve(std::span<const double> picks, std::int32_t splits)
      : positives_(picks.begin(), picks.end()), splits_(splits), fractions_(fractions_of(picks.size())) {
    std::ranges::sort(positives_);
  }

  double largest() const { return positives_.back(); }

  std::vector<double> true_rates(const std::vector<double>& thresholds) const {
    return rates_of(positives_, thresholds);
  }
  // reached: number of negatives that reach each number of thresholds.
  void add_split(const std::vector<double>& true_rates, std::span<std::uint32_t> reached) {
    accumulate(reached);
    sum_ += area_under_curve(true_rates, fractions_, [&](std::size_t t) { return reached[t + 1]; });
  }
  // Also for negative values.
  void add_split(std::vector<double> negatives, const std::vector<double>& thresholds) {
    std::ranges::sort(negatives);
    sum_ += area_under_curve(rates_of(positives_, thresholds), rates_of(negatives, thresholds));
  }
  double mean() const { return sum_ / splits_; }

 private:
  std::vector<double> positives_;  // ascending
  std::int32_t splits_;
  std::vector<double> fractions_;  // [count of negatives]
  double sum_ = 0;
};

}  // namespace

bool ValueDraws::any_negative() {
  if (!any_negative_) any_negative_ = std::ranges::any_of(map_, [](double value) { return value < 0; });
  return *any_negative_;
}

std::span<const std::uint32_t> ValueDraws::points(std::size_t count) {
  return draws_.below(static_cast<std::uint32_t>(map_.size() - 1), count);
}

std::span<const std::uint16_t> ValueDraws::reached(std::int32_t thresholds, double largest) {
  if (thresholds != thresholds_ || largest != largest_) {
    thresholds_ = thresholds;
    largest_ = largest;
    reached_.resize(map_.size() - 1);
    const EvenThresholds even(even_thresholds(thresholds, largest), largest);
    const EvenThresholds::LookUp reached = even.look_up();
    for (std::size_t k = 0; k < reached_.size(); ++k)
      reached_[k] = static_cast<std::uint16_t>(
          map_[k + 1] > largest ? static_cast<std::size_t>(thresholds) + 1 : reached(map_[k + 1]));
  }
  return reached_;
}

namespace {

// A split with thresholds of its own, up to the largest value drawn.
void add_split(Curve& curve, std::span<const std::uint32_t> points, const ValueDraws& draws,
               std::int32_t count, bool any_negative) {
  std::vector<double> negatives;
  negatives.reserve(points.size());
  for (const std::uint32_t point : points) negatives.push_back(draws.value(point));
  const double largest = std::max(curve.largest(), std::ranges::max(negatives));
  const std::vector<double> thresholds = even_thresholds(count, largest);
  if (any_negative || !(largest > 0)) {
    curve.add_split(std::move(negatives), thresholds);
    return;
  }
  const EvenThresholds reached(thresholds, largest);
  Counts counts;
  curve.add_split(curve.true_rates(thresholds),
                  counted<double>(negatives, thresholds.size() + 1, reached.look_up(), counts));
}

}  // namespace

// In most splits no value drawn lies above those of the picks: they have the same thresholds.
double sampled_auc(std::span<const double> picks, ValueDraws& draws, const Splits& splits) {
  if (picks.empty()) return std::numeric_limits<double>::quiet_NaN();
  Curve curve(picks, splits.count);
  const bool any_negative = draws.any_negative();
  const bool shared =
      !any_negative && curve.largest() > 0 && splits.thresholds < std::numeric_limits<std::uint16_t>::max();
  const std::vector<double> thresholds = even_thresholds(splits.thresholds, curve.largest());
  const std::vector<double> true_rates = curve.true_rates(thresholds);
  std::span<const std::uint16_t> reached;
  if (shared) reached = draws.reached(splits.thresholds, curve.largest());
  const auto reached_by = [reached](std::uint32_t point) { return reached[point]; };
  Counts counts;
  std::span<const std::uint32_t> rest = draws.points(static_cast<std::size_t>(splits.count) * picks.size());
  for (; !rest.empty(); rest = rest.subspan(picks.size())) {
    const auto points = rest.first(picks.size());
    std::span<std::uint32_t> count;  // the last one is of values above the thresholds
    if (shared) count = counted(points, thresholds.size() + 2, reached_by, counts);
    if (shared && count.back() == 0)
      curve.add_split(true_rates, count.first(thresholds.size() + 1));
    else
      add_split(curve, points, draws, splits.thresholds, any_negative);
  }
  return curve.mean();
}

}  // namespace salbench
