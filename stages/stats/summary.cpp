// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stats/summary.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "stages/core/check.h"
#include "stages/core/field.h"
#include "stages/stats/distributions.h"

namespace salbench {
namespace {

std::vector<double> defined(std::span<const double> values) {
  std::vector<double> result(values.begin(), values.end());
  std::erase_if(result, [](double value) { return std::isnan(value); });
  return result;
}

// Summed from the first value on: the mean of equal values is that value, without rounding.
double mean_of(std::span<const double> values) {
  double sum = 0;
  for (const double value : values) sum += value - values.front();
  return values.front() + sum / static_cast<double>(values.size());
}

double sample_deviation(std::span<const double> values, double mean) {
  double squares = 0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

}  // namespace

Summary summarise(std::span<const double> values) {
  std::vector<double> sample = defined(values);
  const double scale = scale_against_overflow(sample);
  for (double& value : sample) value *= scale;
  Summary summary;
  summary.n = static_cast<std::int64_t>(sample.size());
  summary.n_undefined = static_cast<std::int64_t>(values.size() - sample.size());
  if (sample.empty()) return summary;
  const double mean = mean_of(sample);
  summary.mean = mean / scale;
  if (sample.size() < 2) return summary;
  const double sd = sample_deviation(sample, mean);
  summary.sd = sd / scale;
  const auto n = static_cast<double>(sample.size());
  const double half_width = student_upper_quantile((1 - kConfidence) / 2, n - 1) * sd / std::sqrt(n);
  summary.ci_low = (mean - half_width) / scale;
  summary.ci_high = (mean + half_width) / scale;
  return summary;
}

Interval student_interval(const Summary& summary) {
  return summary.sd > 0 ? Interval{summary.ci_low, summary.ci_high} : Interval{};
}

double quantile(std::span<const double> values, double q) {
  std::vector<double> sample = defined(values);
  return sample.empty() ? std::numeric_limits<double>::quiet_NaN() : quantile_in_place(sample, q);
}

double quantile_in_place(std::span<double> sample, double q) {
  CHECK_LE(0.0, q);
  CHECK_LE(q, 1.0);
  const double position = q * static_cast<double>(sample.size() - 1);
  const auto at = sample.begin() + static_cast<std::ptrdiff_t>(position);
  std::nth_element(sample.begin(), at, sample.end());
  const double share = position - std::floor(position);
  return share == 0 ? *at : std::lerp(*at, *std::min_element(at + 1, sample.end()), share);
}

double median(std::span<const double> values) { return quantile(values, 0.5); }

}  // namespace salbench
