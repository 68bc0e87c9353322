// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/quantile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "stages/core/check.h"

namespace salbench {

double quantile(std::span<const double> values, double q) {
  CHECK_LE(0.0, q);
  CHECK_LE(q, 1.0);
  std::vector<double> sample(values.begin(), values.end());
  std::erase_if(sample, [](double value) { return std::isnan(value); });
  if (sample.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double position = q * static_cast<double>(sample.size() - 1);
  const auto at = sample.begin() + static_cast<std::ptrdiff_t>(position);
  std::nth_element(sample.begin(), at, sample.end());
  const double share = position - std::floor(position);
  return share == 0 ? *at : std::lerp(*at, *std::min_element(at + 1, sample.end()), share);
}

double median(std::span<const double> values) { return quantile(values, 0.5); }

}  // namespace salbench
