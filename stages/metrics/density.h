// SPDX-License-Identifier: GPL-3.0-or-later
// Distances and similarities of two fields over a shape as distributions of saliency.
//
// A distribution has p_i = s_i / sum(s) at point i. A constant map, including zero, is the uniform
// distribution. Results are NaN without points, for negative values, and if the ground truth is zero
// everywhere.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace salbench {

// Share of a point whose field has this value: scale * value + offset. NaN if there is no distribution.
struct Density {
  double scale = std::numeric_limits<double>::quiet_NaN();
  double offset = 0;

  bool defined() const { return !std::isnan(scale); }
  double of(double value) const { return scale * value + offset; }
};
Density density_of_map(std::span<const double> map, double added = 0);

// Constants that a convention adds to keep the divergence finite: to the values of both fields (a map has
// them in [0, 1], the ground truth in its own unit), to the quotient of the densities and its denominator, or
// to both densities.
struct DivergenceFloors {
  double values = 0, quotient = 0, densities = 0;
};
inline constexpr double kDensityFloor = 2.2204e-16;                          // Matlab's eps to five digits
inline constexpr DivergenceFloors kMitFloors = {.quotient = kDensityFloor};  // [bylinskii2019]
inline constexpr DivergenceFloors kSmoothedFloors = {.values = 1e-12};       // [kummerer2018]
inline constexpr DivergenceFloors kPysaliencyFloors = {.values = 1e-20};
inline constexpr DivergenceFloors kShiftedFloors = {.densities = 1e-12};

// Kullback-Leibler divergence of the map from the ground truth by any of these conventions, in nats:
// sum (g + d) ln(q + (g + d) / (p + d + q)), p and g the densities of the values + v.
double divergence(std::span<const double> map, std::span<const double> saliency,
                  const DivergenceFloors& floors);

// Similarity, or histogram intersection: sum min(p, g); 1 for equal distributions. [judd2012]
double similarity(std::span<const double> map, std::span<const double> saliency);

// A field as a distribution.
struct Distributed {
  std::span<const double> field;  // n
  Density density;

  double at(std::int32_t i) const { return density.of(field[static_cast<std::size_t>(i)]); }
};

// Information gain of p over a baseline b, in bits per pick: mean over the picks of log2(e + p) - log2(e +
// b), e = kDensityFloor. NaN without picks, or if either is no distribution. [kummerer2015]
double information_gain(const Distributed& map, const Distributed& baseline,
                        std::span<const std::int32_t> picked);

}  // namespace salbench
