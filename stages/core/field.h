// SPDX-License-Identifier: GPL-3.0-or-later
// Scalar fields over the points of a shape.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

// Accepted magnitudes, checked when shapes and maps enter. Maps are squared, and so are areas, which are
// products of two coordinates: sums of these must stay far from the limits of double precision. The limits
// apply to the largest magnitude of a map and to the extent of a shape: small single values, as left by a
// rotation or a softmax, are accepted. Only a wrong unit or a broken exporter gives a whole map or shape
// beyond these limits.
inline constexpr double kSmallestMap = 1e-100, kLargestMap = 1e100;
inline constexpr double kSmallestExtent = 1e-50, kLargestCoordinate = 1e50;

// Describes the first unusable value of a map; empty if there is none.
std::string wrong_with_values(FieldView map, bool may_be_nan = false);
std::string wrong_with_coordinates(Points points);

// Throw InputError for such a value. `what` is "the map".
void require_finite(FieldView map, const char* what, bool may_be_nan = false);
void require_finite(Points points);

// Replaces NaN by 0, then scales to [0, 1]; a constant field is unchanged. Throws InputError for an infinite
// value or an overflowing range. [tasse2016]
ScalarField min_max_normalised(std::span<const double> field);

// Sorts in ascending order and removes repeated values.
template <class T>
void sort_and_deduplicate(std::vector<T>& values) {
  std::ranges::sort(values);
  values.erase(std::ranges::unique(values).begin(), values.end());
}

bool is_constant(std::span<const double> field);  // also for an empty field

// Values at the given points, in their order.
ScalarField values_at(std::span<const double> field, std::span<const std::int32_t> points);

// Median, the upper of two middle values; requires at least one value.
double upper_median(std::vector<double> values);

// Density histogram over the field's finite range [min, max]: bin i holds count_i / (n * width_i), the last
// bin closed on the right. A constant field has the range [value - 0.5, value + 0.5], as in NumPy; if it is
// beyond 1e6, where rounding would distort the bins, that of 0.
struct BinnedDensity {
  Histogram density;
  std::array<double, kHistogramBins + 1> edges;
};
BinnedDensity binned_density(std::span<const double> field);

// Points picked by at least one participant, ascending and distinct.
std::vector<std::int32_t> picked_points(const GroundTruth& truth);

}  // namespace salbench
