// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/field.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "stages/core/check.h"

namespace salbench {

ScalarField min_max_normalised(std::span<const double> field) {
  ScalarField result(field.begin(), field.end());
  for (double& value : result)
    if (std::isnan(value)) value = 0;
  if (result.empty()) return result;
  const Eigen::Map<const Eigen::ArrayXd> values(result.data(), static_cast<Eigen::Index>(result.size()));
  const double smallest = values.minCoeff(), largest = values.maxCoeff();
  if (smallest == largest) return result;
  const double from = *std::ranges::find(result, smallest);  // of -0 and 0 the first
  const double range = largest - from;
  if (from == 0 && !std::signbit(from) && range == 1) return result;
  for (double& value : result) value = (value - from) / range;
  return result;
}

bool is_constant(std::span<const double> field) {
  return std::adjacent_find(field.begin(), field.end(), std::not_equal_to<>()) == field.end();
}

ScalarField values_at(std::span<const double> field, std::span<const std::int32_t> points) {
  ScalarField values;
  values.reserve(points.size());
  for (const std::int32_t i : points) values.push_back(field[static_cast<std::size_t>(i)]);
  return values;
}

BinnedDensity binned_density(std::span<const double> field) {
  CHECK_GT(field.size(), 0U);
  auto [low, high] = [&] {
    const auto [first, last] = std::minmax_element(field.begin(), field.end());
    return std::pair(*first, *last);
  }();
  if (low == high) {
    low -= 0.5;
    high += 0.5;
  }
  BinnedDensity result{};
  const double width = (high - low) / kHistogramBins;
  for (std::size_t i = 0; i <= kHistogramBins; ++i) result.edges[i] = low + width * static_cast<double>(i);
  result.edges.back() = high;
  for (const double value : field) {
    // The quotient may land one bin off by rounding: the edges decide.
    auto bin = static_cast<std::size_t>(
        std::clamp((value - low) / (high - low) * kHistogramBins, 0.0, kHistogramBins - 1.0));
    if (value < result.edges[bin]) --bin;
    if (bin + 1 < kHistogramBins && value >= result.edges[bin + 1]) ++bin;
    result.density[bin] += 1;
  }
  for (std::size_t i = 0; i < kHistogramBins; ++i)
    result.density[i] /= static_cast<double>(field.size()) * (result.edges[i + 1] - result.edges[i]);
  return result;
}

std::vector<std::int32_t> picked_points(const GroundTruth& truth) {
  std::vector<std::int32_t> picked;
  for (const auto& participant : truth.picks)
    picked.insert(picked.end(), participant.begin(), participant.end());
  std::sort(picked.begin(), picked.end());
  picked.erase(std::unique(picked.begin(), picked.end()), picked.end());
  return picked;
}

}  // namespace salbench
