// SPDX-License-Identifier: GPL-3.0-or-later
// Scalar fields over the points of a shape.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

// The value at some point is no finite number, nor NaN unless it may be: throws InputError that begins with
// `what`, "the map".
void require_finite(std::span<const double> field, const char* what, bool may_be_nan = false);

// The power of two by which a field is multiplied so that sums over a shape of its values, of their
// differences and of squares of these neither overflow nor lose digits below the smallest double: 1 if the
// largest magnitude is between 2^-256 (9e-78) and 2^480 (3e144), or 0. NaN does not count.
double scale_to_ordinary(std::span<const double> field);

// Replaces NaN by 0, then maps to [0, 1]; a constant field stays as it is. Throws InputError for an infinite
// value. [tasse2016]
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
