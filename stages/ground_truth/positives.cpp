// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/ground_truth/positives.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "stages/core/field.h"

namespace salbench {
namespace {

// The values seen, in descending order.
std::vector<double> seen_values(std::span<const double> density) {
  std::vector<double> values;
  std::ranges::copy_if(density, std::back_inserter(values), [](double value) { return !std::isnan(value); });
  std::ranges::sort(values, std::greater());
  return values;
}

std::vector<std::int32_t> points_where(std::span<const double> density, const auto& taken) {
  std::vector<std::int32_t> points;
  for (std::size_t i = 0; i < density.size(); ++i)
    if (taken(density[i])) points.push_back(static_cast<std::int32_t>(i));
  return points;
}

}  // namespace

std::vector<std::int32_t> points_on_top(std::span<const double> density, double percent) {
  const std::vector<double> values = seen_values(density);
  if (values.empty()) return {};
  constexpr double kRounding = 1e-9;  // equal parts must not differ by it; as auc_top20 has it
  const double most = percent / 100 * static_cast<double>(values.size()) * (1 - kRounding);
  const auto last = static_cast<std::size_t>(std::max(0.0, std::ceil(most) - 1));
  const double lowest = values[std::min(last, values.size() - 1)], minimum = values.back();
  return points_where(density, [&](double value) { return value >= lowest && value > minimum; });
}

std::vector<std::int32_t> points_above_mean(std::span<const double> density) {
  const std::vector<double> values = seen_values(density);
  if (values.empty()) return {};
  const double scale = scale_to_ordinary(values), minimum = values.back();
  const double sum = std::accumulate(values.begin(), values.end(), 0.0,
                                     [&](double so_far, double value) { return so_far + value * scale; });
  const double mean = sum / static_cast<double>(values.size());
  return points_where(density, [&](double value) { return value * scale > mean && value > minimum; });
}

}  // namespace salbench
