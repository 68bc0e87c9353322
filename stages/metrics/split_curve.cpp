// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/split_curve.h"

namespace salbench {

std::vector<double> even_thresholds(std::int32_t count, double largest) {
  std::vector<double> thresholds;
  thresholds.reserve(static_cast<std::size_t>(count));
  for (std::int32_t t = 0; t + 1 < count; ++t) thresholds.push_back(largest * t / (count - 1));
  thresholds.push_back(largest);  // itself: rounding must not lift it above
  return thresholds;
}

void accumulate(std::span<std::uint32_t> counts) {
  std::uint32_t sum = 0;
  for (std::size_t k = counts.size(); k-- > 0;) counts[k] = sum += counts[k];
}

std::vector<double> fractions_of(std::size_t total) {
  std::vector<double> fractions;
  fractions.reserve(total + 1);
  for (std::size_t count = 0; count <= total; ++count)
    fractions.push_back(static_cast<double>(count) / static_cast<double>(total));
  return fractions;
}

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

}  // namespace salbench
