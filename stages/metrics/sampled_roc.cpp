// SPDX-License-Identifier: GPL-3.0-or-later
// Values are counted between thresholds and never sorted: a split is a pass over its draws.
#include "stages/metrics/sampled_roc.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "stages/metrics/reached.h"

namespace salbench {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

using Counts = std::vector<std::uint32_t>;  // [number of thresholds reached]: values, 0..thresholds

// Ascending if `largest` is >= 0.
std::vector<double> even_thresholds(std::int32_t count, double largest) {
  std::vector<double> thresholds;
  thresholds.reserve(static_cast<std::size_t>(count));
  for (std::int32_t t = 0; t + 1 < count; ++t) thresholds.push_back(largest * t / (count - 1));
  thresholds.push_back(largest);  // itself: rounding must not lift it above
  return thresholds;
}

// Turns counts into [number of thresholds reached]: values that reach so many or more.
void accumulate(std::span<std::uint32_t> counts) {
  std::uint32_t sum = 0;
  for (std::size_t k = counts.size(); k-- > 0;) counts[k] = sum += counts[k];
}

// [count]: fraction that so many values are of all.
std::vector<double> fractions_of(std::size_t total) {
  std::vector<double> fractions;
  fractions.reserve(total + 1);
  for (std::size_t count = 0; count <= total; ++count)
    fractions.push_back(static_cast<double>(count) / static_cast<double>(total));
  return fractions;
}

// [threshold]: fraction of the ascending values that reach it. Thresholds need not ascend: those up to a
// negative largest value do not.
std::vector<double> rates_of(const std::vector<double>& values, const std::vector<double>& thresholds) {
  std::vector<double> result;
  result.reserve(thresholds.size());
  std::size_t below = 0;
  for (const double threshold : thresholds) {
    if (below > 0 && values[below - 1] >= threshold) below = 0;
    while (below < values.size() && values[below] < threshold) ++below;
    result.push_back(static_cast<double>(values.size() - below) / static_cast<double>(values.size()));
  }
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

// The same of false rates that are given as counts: reaching(t) values reach threshold t. Between thresholds
// that equally many reach there is no area, and in most splits there are many of them.
template <class Reaching>
double area_under_curve(const std::vector<double>& true_rates, const std::vector<double>& fractions,
                        const Reaching& reaching) {
  double area = 0, true_rate = 1;
  std::size_t count = fractions.size() - 1;  // all
  for (std::size_t t = 0; t < true_rates.size(); ++t) {
    if (const std::size_t next = reaching(t); next != count) {
      area += (fractions[count] - fractions[next]) * (true_rate + true_rates[t]) / 2;
      count = next;
    }
    true_rate = true_rates[t];
  }
  return area + fractions[count] * true_rate / 2;
}

// Part of the weight that lies below each threshold.
std::vector<double> parts_below(const Distribution& map, const std::vector<double>& thresholds) {
  std::vector<double> parts;
  parts.reserve(thresholds.size());
  for (const double threshold : thresholds) parts.push_back(map.weight_below(threshold) / map.total());
  return parts;
}

std::vector<double> tenths_of_range(const Distribution& map) {
  constexpr int kSteps = 10;
  const double lowest = map.values.front(), range = map.values.back() - lowest;
  std::vector<double> thresholds;
  for (int step = 0; step <= kSteps; ++step) thresholds.push_back(lowest + range * step / kSteps);
  return thresholds;
}

constexpr std::size_t kLanes = 4;

// [bin]: how many of the numbers fall in it, of `bins`. In lanes: where most fall in the same bin, each would
// wait for the count of the one before.
template <class Number, class BinOf>
std::span<std::uint32_t> counted(std::span<const Number> numbers, std::size_t bins, BinOf bin_of,
                                 Counts& counts) {
  constexpr std::size_t kWorthLanes = 64;  // numbers
  const std::size_t lanes = numbers.size() < kWorthLanes ? 1 : kLanes;
  counts.assign(lanes * bins, 0);
  std::uint32_t* const count = counts.data();
  std::size_t i = 0;
  if (lanes > 1) {
    for (; i + kLanes <= numbers.size(); i += kLanes)
      for (std::size_t lane = 0; lane < kLanes; ++lane) ++count[lane * bins + bin_of(numbers[i + lane])];
    for (std::size_t lane = 1; lane < kLanes; ++lane)
      for (std::size_t k = 0; k < bins; ++k) count[k] += count[lane * bins + k];
  }
  for (; i < numbers.size(); ++i) ++count[bin_of(numbers[i])];
  return {count, bins};
}

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
  // How many negatives reach each number of thresholds.
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

// In lanes, since each comparison waits for the one before.
std::uint64_t largest_of(std::span<const std::uint64_t> numbers) {
  std::array<std::uint64_t, kLanes> largest{};
  std::size_t i = 0;
  for (; i + kLanes <= numbers.size(); i += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      largest[lane] = std::max(largest[lane], numbers[i + lane]);
  for (; i < numbers.size(); ++i) largest[0] = std::max(largest[0], numbers[i]);
  return std::ranges::max(largest);
}

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
    const EvenReached even(even_thresholds(thresholds, largest), largest);
    const EvenReached::LookUp reached = even.look_up();
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
  const EvenReached reached(thresholds, largest);
  Counts counts;
  curve.add_split(curve.true_rates(thresholds),
                  counted<double>(negatives, thresholds.size() + 1, reached.look_up(), counts));
}

}  // namespace

// In most splits no value drawn lies above those of the picks: they have the same thresholds.
double sampled_auc(std::span<const double> picks, ValueDraws& draws, const Splits& splits) {
  if (picks.empty()) return kUndefined;
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

namespace {

// The thresholds of a curve, and how they divide picks and draws.
struct Rungs {
  std::vector<double> thresholds;
  std::vector<double> true_rates;
  std::vector<double> positions;  // part of the weight below each threshold: where a draw reaches it
};
using SharedRungs = std::shared_ptr<const Rungs>;

SharedRungs rungs_of(const Distribution& map, const std::vector<double>& thresholds,
                     const std::vector<double>& positives) {
  return std::make_shared<const Rungs>(
      Rungs{thresholds, rates_of(positives, thresholds), parts_below(map, thresholds)});
}

// The rungs of all curves in one order, so that a draw is looked up once.
class Ladder {
 public:
  Ladder(std::vector<SharedRungs> rungs, std::size_t draws)
      : rungs_(std::move(rungs)), positions_(sorted_positions(rungs_)), reached_(positions_, draws) {
    for (const SharedRungs& own : rungs_) {
      auto& places = places_.emplace_back();
      places.reserve(own->positions.size());
      std::size_t place = 0;
      for (std::size_t t = 0; t < own->positions.size(); ++t) {
        if (t > 0 && own->positions[t] < own->positions[t - 1]) place = 0;
        while (place < positions_.size() && positions_[place] <= own->positions[t]) ++place;
        places.push_back(place);
      }
    }
  }

  const Rungs& of(std::size_t curve) const { return *rungs_[curve]; }
  // [threshold]: how many positions a draw has reached that reaches this one, at least.
  const std::vector<std::size_t>& places(std::size_t curve) const { return places_[curve]; }
  std::size_t positions() const { return positions_.size(); }
  Reached::LookUp reached() const { return reached_.look_up(); }

 private:
  // Most ascend already.
  static std::vector<double> sorted_positions(const std::vector<SharedRungs>& rungs) {
    std::vector<double> all;
    for (const SharedRungs& own : rungs) {
      const auto middle = all.insert(all.end(), own->positions.begin(), own->positions.end());
      if (!std::is_sorted(middle, all.end())) std::sort(middle, all.end());
      std::inplace_merge(all.begin(), middle, all.end());
    }
    return all;
  }

  std::vector<SharedRungs> rungs_;                // [curve]
  std::vector<double> positions_;                 // of all curves, ascending
  std::vector<std::vector<std::size_t>> places_;  // [curve]
  Reached reached_;
};

// Sums of the areas over the splits, of curves over something.
class QuantileSums {
 public:
  QuantileSums(std::span<const QuantileCurve> curves, std::span<const double> picks, const Splits& splits)
      : curves_(curves),
        splits_(splits),
        positives_(picks.begin(), picks.end()),
        fractions_(fractions_of(picks.size())),
        areas_(curves.size(), 0),
        largest_(curves.size(), 0) {
    std::ranges::sort(positives_);
    for (const QuantileCurve& curve : curves)
      lasting_.push_back(curve.thresholds == Thresholds::tenths
                             ? rungs_of(curve.map, tenths_of_range(curve.map), positives_)
                             : nullptr);
  }

  void add_split(std::span<const std::uint64_t> draws) {
    set_largest(draws);
    const Ladder& ladder = ladder_up_to_largest();
    const auto at_least = counted(draws, ladder.positions() + 1, ladder.reached(), counts_);
    accumulate(at_least);
    for (std::size_t c = 0; c < curves_.size(); ++c) {
      const Rungs& rungs = ladder.of(c);
      if (is_even(c) && !(largest_[c] > 0)) {  // the thresholds descend
        areas_[c] +=
            area_under_curve(rungs.true_rates, rates_of(values_of(draws, curves_[c].map), rungs.thresholds));
        continue;
      }
      const std::vector<std::size_t>& places = ladder.places(c);
      areas_[c] +=
          area_under_curve(rungs.true_rates, fractions_, [&](std::size_t t) { return at_least[places[t]]; });
    }
  }
  double mean(std::size_t curve) const { return areas_[curve] / splits_.count; }

 private:
  bool is_even(std::size_t curve) const { return curves_[curve].thresholds == Thresholds::even; }

  void set_largest(std::span<const std::uint64_t> draws) {
    std::optional<double> largest_draw;
    for (std::size_t c = 0; c < curves_.size(); ++c) {
      if (!is_even(c)) continue;
      largest_[c] = positives_.back();
      const Distribution& map = curves_[c].map;
      if (positives_.back() >= map.values.back()) continue;
      if (!largest_draw) largest_draw = uniform_of(largest_of(draws));
      largest_[c] = std::max(positives_.back(), map.quantile(*largest_draw));
    }
  }

  // Few points have the largest values, so that splits share their ladders.
  const Ladder& ladder_up_to_largest() {
    if (ladder_ != nullptr && largest_ == ladder_->first) return ladder_->second;
    if (const auto known = ladders_.find(largest_); known != ladders_.end())
      return (ladder_ = &*known)->second;
    std::vector<SharedRungs> rungs = lasting_;
    for (std::size_t c = 0; c < curves_.size(); ++c)
      if (is_even(c))
        rungs[c] = rungs_of(curves_[c].map, even_thresholds(splits_.thresholds, largest_[c]), positives_);
    ladder_ = &*ladders_.emplace(largest_, Ladder(std::move(rungs), positives_.size())).first;
    return ladder_->second;
  }

  static std::vector<double> values_of(std::span<const std::uint64_t> draws, const Distribution& map) {
    std::vector<double> values;
    for (const std::uint64_t draw : draws) values.push_back(map.quantile(uniform_of(draw)));
    std::ranges::sort(values);
    return values;
  }

  std::span<const QuantileCurve> curves_;
  Splits splits_;
  std::vector<double> positives_;  // ascending
  std::vector<double> fractions_;  // [count of draws]
  std::vector<double> areas_;      // [curve]
  // [curve]: of the picks' values and the draws'; 0 where the thresholds do not depend on it.
  std::vector<double> largest_;
  std::vector<SharedRungs> lasting_;  // [curve]: of thresholds that no split changes; or none
  std::map<std::vector<double>, Ladder> ladders_;
  const std::pair<const std::vector<double>, Ladder>* ladder_ = nullptr;  // of the split before
  Counts counts_;                                                         // of one split
};

}  // namespace

std::vector<double> quantile_aucs(std::span<const QuantileCurve> curves, std::span<const double> picks,
                                  Draws& draws, const Splits& splits) {
  std::vector<double> areas(curves.size(), kUndefined);
  std::vector<QuantileCurve> defined;
  for (const QuantileCurve& curve : curves)
    if (curve.map.total() > 0) defined.push_back(curve);
  if (picks.empty() || defined.empty()) return areas;
  QuantileSums sums(defined, picks, splits);
  std::span<const std::uint64_t> rest = draws.numbers(static_cast<std::size_t>(splits.count) * picks.size());
  for (; !rest.empty(); rest = rest.subspan(picks.size())) sums.add_split(rest.first(picks.size()));
  for (std::size_t c = 0, d = 0; c < curves.size(); ++c)
    if (curves[c].map.total() > 0) areas[c] = sums.mean(d++);
  return areas;
}

}  // namespace salbench
