// SPDX-License-Identifier: GPL-3.0-or-later
// The ROC curve of one split: as many random draws as there are picks stand for the negatives. It runs from
// (1, 1) over the rates of values >= each threshold to (0, 0). Values are counted between thresholds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace salbench {

struct Splits {
  std::int32_t count;       // draws that the area is averaged over
  std::int32_t thresholds;  // evenly spaced from 0 to the largest value among picks and negatives

  bool operator==(const Splits&) const = default;
};

using Counts = std::vector<std::uint32_t>;  // [number of thresholds reached]: values, 0..thresholds

// From 0 to `largest`; they ascend if it is >= 0.
std::vector<double> even_thresholds(std::int32_t count, double largest);

// Turns counts into [number of thresholds reached]: values that reach so many or more.
void accumulate(std::span<std::uint32_t> counts);

// [count]: fraction that so many values are of all.
std::vector<double> fractions_of(std::size_t total);

// [threshold]: fraction of the ascending values that reach it. Thresholds need not ascend: those up to a
// negative largest value do not.
std::vector<double> rates_of(const std::vector<double>& values, const std::vector<double>& thresholds);

double area_under_curve(const std::vector<double>& true_rates, const std::vector<double>& false_rates);

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

inline constexpr std::size_t kCountingLanes = 4;

// [bin]: how many of the numbers fall in it, of `bins`. In lanes: where most fall in the same bin, each would
// wait for the count of the one before.
template <class Number, class BinOf>
std::span<std::uint32_t> counted(std::span<const Number> numbers, std::size_t bins, BinOf bin_of,
                                 Counts& counts) {
  constexpr std::size_t kWorthLanes = 64;  // numbers
  const std::size_t lanes = numbers.size() < kWorthLanes ? 1 : kCountingLanes;
  counts.assign(lanes * bins, 0);
  std::uint32_t* const count = counts.data();
  std::size_t i = 0;
  if (lanes > 1) {
    for (; i + kCountingLanes <= numbers.size(); i += kCountingLanes)
      for (std::size_t lane = 0; lane < kCountingLanes; ++lane)
        ++count[lane * bins + bin_of(numbers[i + lane])];
    for (std::size_t lane = 1; lane < kCountingLanes; ++lane)
      for (std::size_t k = 0; k < bins; ++k) count[k] += count[lane * bins + k];
  }
  for (; i < numbers.size(); ++i) ++count[bin_of(numbers[i])];
  return {count, bins};
}

}  // namespace salbench
