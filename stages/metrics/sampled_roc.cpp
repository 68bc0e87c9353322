// SPDX-License-Identifier: GPL-3.0-or-later
// Values are counted between thresholds and never sorted: a split is a pass over its draws.
#include "stages/metrics/sampled_roc.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
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
  for (std::int32_t t = 0; t + 1 < count; ++t) thresholds.push_back(largest * t / (count - 1));
  thresholds.push_back(largest);  // itself: rounding must not lift it above
  return thresholds;
}

// Turns counts into [number of thresholds reached]: values that reach so many or more.
void accumulate(std::span<std::uint32_t> counts) {
  for (std::size_t k = counts.size() - 1; k-- > 0;) counts[k] += counts[k + 1];
}

// [count]: fraction that so many values are of all.
std::vector<double> fractions_of(std::size_t total) {
  std::vector<double> fractions;
  for (std::size_t count = 0; count <= total; ++count)
    fractions.push_back(static_cast<double>(count) / static_cast<double>(total));
  return fractions;
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

// The curve of one set of picks, split by split.
class Curve {
 public:
  Curve(std::span<const double> picks, std::int32_t splits)
      : positives_(picks.begin(), picks.end()), splits_(splits), fractions_(fractions_of(picks.size())) {
    std::ranges::sort(positives_);
  }

  double largest() const { return positives_.back(); }

  void set_thresholds(const std::vector<double>& thresholds) {
    true_rates_ = rates_of(positives_, thresholds);
    counts_.assign(thresholds.size() + 1, 0);
  }
  template <class Reached>
  void add_negatives(std::span<const double> negatives, const Reached& thresholds_reached) {
    std::uint32_t* const counts = counts_.data();
    for (const double value : negatives) ++counts[thresholds_reached(value)];
  }
  void end_split() {
    accumulate(counts_);
    sum_ += area_under_curve(true_rates_, fractions_, [this](std::size_t t) { return counts_[t + 1]; });
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
  std::vector<double> fractions_;  // [count of negatives]
  std::vector<double> true_rates_;
  Counts counts_;
  double sum_ = 0;
};

struct Extremes {
  double smallest, largest;
};

// In lanes, since each comparison waits for the one before.
Extremes extremes_of(std::span<const double> values) {
  constexpr std::size_t kLanes = 4;
  std::array<double, kLanes> smallest, largest;
  smallest.fill(values.front());
  largest.fill(values.front());
  const auto take = [&](std::size_t lane, double value) {
    smallest[lane] = value < smallest[lane] ? value : smallest[lane];
    largest[lane] = value > largest[lane] ? value : largest[lane];
  };
  std::size_t i = 0;
  for (; i + kLanes <= values.size(); i += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) take(lane, values[i + lane]);
  for (; i < values.size(); ++i) take(0, values[i]);
  return {*std::ranges::min_element(smallest), *std::ranges::max_element(largest)};
}

}  // namespace

double sampled_auc(std::span<const double> picks, ValueDraws& draws, const Splits& splits) {
  if (picks.empty()) return kUndefined;
  Curve curve(picks, splits.count);
  std::span<const double> rest = draws.first(static_cast<std::size_t>(splits.count) * picks.size());
  std::vector<double> thresholds;
  std::optional<EvenReached> reached;
  double up_to = kUndefined;  // of the thresholds
  for (; !rest.empty(); rest = rest.subspan(picks.size())) {
    const auto negatives = rest.first(picks.size());
    const Extremes extremes = extremes_of(negatives);
    const double largest = std::max(curve.largest(), extremes.largest);
    if (largest != up_to) {
      thresholds = even_thresholds(splits.thresholds, up_to = largest);
      curve.set_thresholds(thresholds);
      reached.emplace(thresholds, largest);
    }
    if (!(largest > 0) || extremes.smallest < 0) {  // no map that was matched, but a constant one may be
      curve.end_split({negatives.begin(), negatives.end()}, thresholds);
      continue;
    }
    curve.add_negatives(negatives, *reached);
    curve.end_split();
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

Rungs rungs_of(const Distribution& map, const std::vector<double>& thresholds,
               const std::vector<double>& positives) {
  return {thresholds, rates_of(positives, thresholds), parts_below(map, thresholds)};
}

// The rungs of all curves in one order, so that a draw is looked up once.
class Ladder {
 public:
  Ladder(std::vector<Rungs> rungs, std::size_t draws)
      : rungs_(std::move(rungs)), positions_(sorted_positions(rungs_)), reached_(positions_, draws) {
    for (const Rungs& own : rungs_) {
      auto& places = places_.emplace_back();
      for (const double position : own.positions)
        places.push_back(
            static_cast<std::size_t>(std::ranges::upper_bound(positions_, position) - positions_.begin()));
    }
  }

  const Rungs& of(std::size_t curve) const { return rungs_[curve]; }
  // [threshold]: how many positions a draw has reached that reaches this one, at least.
  const std::vector<std::size_t>& places(std::size_t curve) const { return places_[curve]; }
  std::size_t positions() const { return positions_.size(); }
  std::size_t reached(double draw) const { return reached_(draw); }

 private:
  static std::vector<double> sorted_positions(const std::vector<Rungs>& rungs) {
    std::vector<double> all;
    for (const Rungs& own : rungs) all.insert(all.end(), own.positions.begin(), own.positions.end());
    std::ranges::sort(all);
    return all;
  }

  std::vector<Rungs> rungs_;                      // [curve]
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
                             : Rungs{});
  }

  void add_split(std::span<const double> draws) {
    set_largest(extremes_of(draws).largest);
    const Ladder& ladder = ladder_up_to_largest();
    count(draws, ladder);
    for (std::size_t c = 0; c < curves_.size(); ++c) {
      const Rungs& rungs = ladder.of(c);
      if (is_even(c) && !(largest_[c] > 0)) {  // the thresholds descend
        areas_[c] +=
            area_under_curve(rungs.true_rates, rates_of(values_of(draws, curves_[c].map), rungs.thresholds));
        continue;
      }
      const std::vector<std::size_t>& places = ladder.places(c);
      areas_[c] +=
          area_under_curve(rungs.true_rates, fractions_, [&](std::size_t t) { return at_least_[places[t]]; });
    }
  }
  double mean(std::size_t curve) const { return areas_[curve] / splits_.count; }

 private:
  static constexpr std::size_t kLanes = 4, kWorthLanes = 64;  // draws

  bool is_even(std::size_t curve) const { return curves_[curve].thresholds == Thresholds::even; }

  void set_largest(double largest_draw) {
    for (std::size_t c = 0; c < curves_.size(); ++c)
      if (is_even(c)) largest_[c] = std::max(positives_.back(), curves_[c].map.quantile(largest_draw));
  }

  // Few points have the largest values, so that splits share their ladders.
  const Ladder& ladder_up_to_largest() {
    if (const auto known = ladders_.find(largest_); known != ladders_.end()) return known->second;
    std::vector<Rungs> rungs = lasting_;
    for (std::size_t c = 0; c < curves_.size(); ++c)
      if (is_even(c))
        rungs[c] = rungs_of(curves_[c].map, even_thresholds(splits_.thresholds, largest_[c]), positives_);
    return ladders_.emplace(largest_, Ladder(std::move(rungs), positives_.size())).first->second;
  }

  // In lanes: where most draws reach equally few thresholds, each would wait for the count of the one before.
  void count(std::span<const double> draws, const Ladder& ladder) {
    const std::size_t bins = ladder.positions() + 1;
    const std::size_t lanes = draws.size() < kWorthLanes ? 1 : kLanes;
    at_least_.assign(lanes * bins, 0);
    std::uint32_t* const counts = at_least_.data();
    std::size_t i = 0;
    if (lanes > 1) {
      for (; i + kLanes <= draws.size(); i += kLanes)
        for (std::size_t lane = 0; lane < kLanes; ++lane)
          ++counts[lane * bins + ladder.reached(draws[i + lane])];
      for (std::size_t lane = 1; lane < kLanes; ++lane)
        for (std::size_t k = 0; k < bins; ++k) counts[k] += counts[lane * bins + k];
    }
    for (; i < draws.size(); ++i) ++counts[ladder.reached(draws[i])];
    accumulate({counts, bins});
  }

  static std::vector<double> values_of(std::span<const double> draws, const Distribution& map) {
    std::vector<double> values;
    for (const double draw : draws) values.push_back(map.quantile(draw));
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
  std::vector<Rungs> lasting_;  // [curve]: of thresholds that no split changes
  std::map<std::vector<double>, Ladder> ladders_;
  Counts at_least_;  // [positions reached]: draws that reach so many or more
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
  std::span<const double> rest = draws.uniform(static_cast<std::size_t>(splits.count) * picks.size());
  for (; !rest.empty(); rest = rest.subspan(picks.size())) sums.add_split(rest.first(picks.size()));
  for (std::size_t c = 0, d = 0; c < curves.size(); ++c)
    if (curves[c].map.total() > 0) areas[c] = sums.mean(d++);
  return areas;
}

}  // namespace salbench
