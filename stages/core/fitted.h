// SPDX-License-Identifier: GPL-3.0-or-later
// Fitted densities, and the counts that they are fitted to; stages/fitting computes both.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace salbench {

inline constexpr std::size_t kValueKnots = 20, kDistanceKnots = 10;

// Input of a fit: shares of the points of a shape, and of its ground truth, by blur, value of the map and
// distance from the centroid.
struct DensityCounts {
  std::int32_t fold = 0;                 // part of the set that the shape belongs to
  std::vector<std::int32_t> cells = {};  // ascending: (blur * value bins + value bin) * distance bins + bin
  std::vector<float> points = {};        // of each cell; those of a blur sum to 1
  std::vector<float> marked = {};        // likewise. None of all three where the ground truth says nothing
};

// The density of a point is proportional to exp(value(v) + distance(d)), both linear between knots: v is the
// map, blurred and scaled to [0, 1], d the distance from the centroid in R.
struct DensityFit {
  std::int64_t shapes = 0;                        // that it was fitted to; 0: there are none, and no density
  double blur = 0;                                // standard deviation along the surface, in R
  double gain = 0;                                // over the uniform map on these shapes, mean, in bits
  std::array<double, kValueKnots> value{};        // at v = 0, 1/19, ..., 1; does not decrease
  std::array<double, kDistanceKnots> distance{};  // at d = 0, 1/9, ..., 1
};
using DensityFits = std::vector<DensityFit>;  // [fold]: fitted to the shapes of all others

}  // namespace salbench
