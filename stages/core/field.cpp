// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <Eigen/Core>
#include <fmt/format.h>

#include "stages/core/check.h"
#include "stages/core/errors.h"

namespace salbench {

namespace {

Eigen::Map<const Eigen::ArrayXd> as_array(std::span<const double> field) {
  return {field.data(), static_cast<Eigen::Index>(field.size())};
}

// Infinite or NaN if any value is; otherwise at least the largest magnitude.
double sum_of_magnitudes(FieldView field) { return as_array(field).abs().sum(); }

// Cheap test that holds for nearly all maps, before the search for a wrong value.
bool can_be_computed_with(FieldView map) {
  const double sum = sum_of_magnitudes(map);
  return sum == 0 || (sum <= kLargestMap && sum >= 2 * kSmallestMap * static_cast<double>(map.size()));
}

}  // namespace

std::string wrong_with_values(FieldView map, bool may_be_nan) {
  if (can_be_computed_with(map)) return {};
  double largest = 0;
  std::size_t place = 0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double magnitude = std::abs(map[i]);
    if (!std::isfinite(magnitude) && !(may_be_nan && std::isnan(magnitude)))
      return fmt::format("value {} (0-based) is {}, expected a finite number{}", i, map[i],
                         may_be_nan ? ", or NaN" : "");
    if (magnitude > largest) {
      largest = magnitude;
      place = i;
    }
  }
  if (largest == 0 || (largest >= kSmallestMap && largest <= kLargestMap)) return {};
  return fmt::format(
      "value {} (0-based) is {:g}, the largest magnitude, expected {:g} to {:g}: rescale all values", place,
      map[place], kSmallestMap, kLargestMap);
}

std::string wrong_with_coordinates(Points points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite())
      return fmt::format("point {} (0-based) has a coordinate that is not finite", i);
    if (const double largest = points[i].cwiseAbs().maxCoeff(); largest > kLargestCoordinate)
      return fmt::format(
          "point {} (0-based) has a coordinate of {:g}, expected at most {:g}: scale the shape", i, largest,
          kLargestCoordinate);
  }
  return {};
}

void require_finite(FieldView map, const char* what, bool may_be_nan) {
  if (const std::string wrong = wrong_with_values(map, may_be_nan); !wrong.empty())
    throw ShapeError(fmt::format("{}: {}", what, wrong));
}

void require_finite(Points points) {
  if (const std::string wrong = wrong_with_coordinates(points); !wrong.empty()) throw ShapeError(wrong);
}

ScalarField min_max_normalised(std::span<const double> field) {
  ScalarField result(field.begin(), field.end());
  if (!std::isfinite(sum_of_magnitudes(field)))
    for (double& value : result)
      if (std::isnan(value)) value = 0;
  if (result.empty()) return result;
  const double smallest = as_array(result).minCoeff(), largest = as_array(result).maxCoeff();
  if (smallest == largest && std::isfinite(largest)) return result;
  if (!std::isfinite(largest - smallest)) require_finite(field, "the map", true);
  const double from = smallest != 0 ? smallest : *std::ranges::find(result, 0.0);  // the first of -0 and 0
  const double range = largest - from;
  if (from == 0 && !std::signbit(from) && range == 1) return result;
  for (double& value : result) value = (value - from) / range;
  return result;
}

bool is_constant(std::span<const double> field) {
  return std::ranges::adjacent_find(field, std::not_equal_to<>()) == field.end();
}

ScalarField values_at(std::span<const double> field, std::span<const std::int32_t> points) {
  ScalarField values;
  values.reserve(points.size());
  for (const std::int32_t i : points) values.push_back(field[static_cast<std::size_t>(i)]);
  return values;
}

double upper_median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

BinnedDensity binned_density(std::span<const double> field) {
  constexpr double kLargestMiddle = 1e6;
  CHECK_GT(field.size(), 0U);
  auto [low, high] = [&] {
    const auto [first, last] = std::ranges::minmax_element(field);
    return std::pair(*first, *last);
  }();
  if (low == high) {
    if (std::abs(low) > kLargestMiddle) return binned_density(ScalarField(field.size(), 0.0));
    low -= 0.5;
    high += 0.5;
  }
  CHECK_LT(high - low, std::numeric_limits<double>::infinity());  // also fails for NaN
  BinnedDensity result{};
  const double width = (high - low) / kHistogramBins;
  for (std::size_t i = 0; i <= kHistogramBins; ++i) result.edges[i] = low + width * static_cast<double>(i);
  result.edges.back() = high;
  for (const double value : field) {
    // Rounding may shift the quotient by one bin: the edges decide.
    const double place = (value - low) / (high - low) * kHistogramBins;
    CHECK_LE(0.0, place);
    auto bin = static_cast<std::size_t>(std::min(place, kHistogramBins - 1.0));
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
  sort_and_deduplicate(picked);
  return picked;
}

}  // namespace salbench
