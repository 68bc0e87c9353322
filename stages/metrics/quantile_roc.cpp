// SPDX-License-Identifier: GPL-3.0-or-later
// The draws of a split are looked up once for all curves.
#include "stages/metrics/quantile_roc.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "stages/metrics/threshold_table.h"

namespace salbench {
namespace {

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

// In lanes, since each comparison waits for the one before.
std::uint64_t largest_of(std::span<const std::uint64_t> numbers) {
  std::array<std::uint64_t, kCountingLanes> largest{};
  std::size_t i = 0;
  for (; i + kCountingLanes <= numbers.size(); i += kCountingLanes)
    for (std::size_t lane = 0; lane < kCountingLanes; ++lane)
      largest[lane] = std::max(largest[lane], numbers[i + lane]);
  for (; i < numbers.size(); ++i) largest[0] = std::max(largest[0], numbers[i]);
  return std::ranges::max(largest);
}

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
  ThresholdTable::LookUp reached() const { return reached_.look_up(); }

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
  ThresholdTable reached_;
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
  std::vector<double> areas(curves.size(), std::numeric_limits<double>::quiet_NaN());
  std::vector<QuantileCurve> defined;
  for (const QuantileCurve& curve : curves)
    if (curve.map.total() > 0) defined.push_back(curve);
  if (picks.empty()) return areas;
  QuantileSums sums(defined, picks, splits);
  std::span<const std::uint64_t> rest = draws.numbers(static_cast<std::size_t>(splits.count) * picks.size());
  for (; !rest.empty(); rest = rest.subspan(picks.size())) sums.add_split(rest.first(picks.size()));
  for (std::size_t c = 0, d = 0; c < curves.size(); ++c)
    if (curves[c].map.total() > 0) areas[c] = sums.mean(d++);
  return areas;
}

}  // namespace salbench
