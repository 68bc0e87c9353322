// SPDX-License-Identifier: GPL-3.0-or-later
// The bootstrap over the units of inference. One set of resamples serves every column of a table, so that
// means, differences and ranks of models are compared within the same resample. [efron1993]
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <vector>

#include "stages/stats/summary.h"

namespace salbench {

// Values of several columns on the same units, row-major; none is NaN.
struct Columns {
  std::size_t count = 0;       // of columns
  std::vector<double> values;  // units x count

  std::size_t units() const { return count == 0 ? 0 : values.size() / count; }
  double at(std::size_t unit, std::size_t column) const { return values[unit * count + column]; }
  std::vector<double> column(std::size_t c) const;
  // Means over the units. n > 0; the mean of equal values is that value, without rounding.
  std::vector<double> means() const;
};

inline constexpr std::size_t kResamples = 10000;

// Resamples of units, drawn with replacement. They depend on the seed and the number of units alone, so that
// tables on as many units share them; how often each unit is in each is kept, a byte each. Thread-safe.
class Bootstrap {
 public:
  explicit Bootstrap(std::uint64_t seed, std::size_t resamples = kResamples);

  // Means of the columns over each resample: resamples x columns.
  Columns means(const Columns& columns) const;

 private:
  const std::vector<std::uint8_t>& times_drawn(std::size_t units) const;  // resamples x units

  std::uint64_t seed_;
  std::size_t resamples_;
  mutable std::mutex making_;
  mutable std::map<std::size_t, std::vector<std::uint8_t>> times_drawn_;  // by number of units
};

// 95 % interval of the mean of a sample, bias-corrected and accelerated, from its resampled means; none for
// fewer than two values, or for equal ones. [efron1987]
Interval bca_interval(std::span<const double> sample, std::span<const double> resampled_means);

// With fewer units, all of them lie on one side of a mean more often than in one of twenty samples, and so do
// all resamples, whatever percentiles are taken.
inline constexpr std::size_t kMinUnitsOfPercentiles = 6;

// 95 % interval of any function of the means of `units` units, from its values in their resamples:
// percentiles at the levels that give a mean of normal values Student's interval. Ends are among the values,
// which may be infinite. None for fewer than kMinUnitsOfPercentiles units, where a value is NaN, or for equal
// finite values. [hesterberg2015]
Interval percentile_interval(std::vector<double> resampled, std::size_t units);

}  // namespace salbench
