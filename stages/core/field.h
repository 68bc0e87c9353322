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

// Magnitudes that can be computed with, checked where shapes and maps enter. Maps are squared, and so are
// areas, the products of two coordinates: sums of these stay far from the limits of double precision. What
// counts is the largest magnitude of a map and the extent of a shape: single values near 0 are what a
// rotation or a softmax leaves of them, and pass beside larger ones. A whole map or shape beyond these limits
// comes from a wrong unit or a broken exporter only.
inline constexpr double kSmallestMap = 1e-100, kLargestMap = 1e100;
inline constexpr double kSmallestExtent = 1e-50, kLargestCoordinate = 1e50;

// Describes the first value of a map that cannot be computed with; empty if there is none.
std::string wrong_with_values(FieldView map, bool may_be_nan = false);
std::string wrong_with_coordinates(Points points);

// Throw InputError for it. `what` is "the map".
void require_finite(FieldView map, const char* what, bool may_be_nan = false);
void require_finite(Points points);

// Replaces NaN by 0, then maps to [0, 1]; a constant field stays as it is. Throws InputError for an infinite
// value, and where the range overflows. [tasse2016]
ScalarField min_max_normalised(std::span<const double> field);

// Leaves each value once, in ascending order.
template <class T>
void sort_and_deduplicate(std::vector<T>& values) {
  std::ranges::sort(values);
  values.erase(std::ranges::unique(values).begin(), values.end());
}

bool is_constant(std::span<const double> field);  // also true of an empty field

// The values at some points, in the order of the points.
ScalarField values_at(std::span<const double> field, std::span<const std::int32_t> points);

// The middle of the values, the upper one of two; there is at least one.
double upper_median(std::vector<double> values);

// Density histogram over the field's own range [min, max], which is finite: bin i holds count_i / (n *
// width_i), the last bin closed on the right. The range of a constant field is [value - 0.5, value + 0.5], as
// in NumPy; of one beyond 1e6, where rounding would spoil the bins, that of 0.
struct BinnedDensity {
  Histogram density;
  std::array<double, kHistogramBins + 1> edges;
};
BinnedDensity binned_density(std::span<const double> field);

// The points that at least one participant picked: ascending, each once.
std::vector<std::int32_t> picked_points(const GroundTruth& truth);

}  // namespace salbench
