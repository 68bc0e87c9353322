// SPDX-License-Identifier: GPL-3.0-or-later
// Distances and similarities of two fields over a shape, most of them as distributions of saliency.
//
// A distribution has p_i = w_i s_i / sum(w s) at point i; its density is d_i = s_i u / sum(w s), per vertex
// (u = 1) or relative to a uniform one (by area, u = the whole area): Measure::unit. A field that is
// constant, zero included, is the uniform distribution. Everything is NaN over nothing (an empty measure),
// where a value is negative, and where the ground truth is zero everywhere.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "stages/metrics/measure.h"

namespace salbench {

// Floors, which keep logarithms of zeros finite. The first is added to densities, in their unit: the share of
// a vertex in the whole, or by area the multiple of the uniform density; it is that of the MIT benchmark,
// Matlab's eps to five digits. The second is added to values: of a map, which has them in [0, 1], and of the
// ground truth in its own unit.
inline constexpr double kDensityFloor = 2.2204e-16;
inline constexpr double kValueFloor = 1e-12;

// Density of a field where it has this value: scale * value + offset. NaN if there is no such distribution.
struct Density {
  double scale = std::numeric_limits<double>::quiet_NaN();
  double offset = 0;

  bool defined() const { return !std::isnan(scale); }
  double of(double value) const { return scale * value + offset; }
};
using Densities = std::array<Density, 2>;  // [weighting]
Densities densities_of_map(std::span<const double> map, const Measures& measures, double added = 0);
Densities densities_of_truth(std::span<const double> saliency, const Measures& measures, double added = 0);

struct DensityInput {
  std::span<const double> map, saliency;                        // n; the ground truth as people marked it
  std::span<const double> normalised_map, normalised_saliency;  // min-max
  Densities map_densities;
};

struct DensityScores {
  // Kullback-Leibler divergence of the map from the ground truth, in nats: sum (w/u) g ln(e + g / (p + e)),
  // g and p the densities, e = kDensityFloor. Per vertex these are the maps scaled to the sum 1.
  // [bylinskii2019]
  double kl;
  // The same of smoothed fields, s + kValueFloor in place of s and no e: sum (w/u) g ln(g / p).
  // [kummerer2018]
  double kl_smoothed;
  // Similarity, or histogram intersection: sum (w/u) min(p, g); 1 for equal distributions. [judd2012]
  double sim, sim_of_normalised;
};
std::array<DensityScores, 2> density_scores(const DensityInput& in, const Measures& measures);  // [weighting]

// What a convention adds, and where, so that the divergence is finite: to the values of both fields, to the
// quotient of the densities and its denominator, or to both densities.
struct DivergenceFloors {
  double values = 0, quotient = 0, densities = 0;
};
inline constexpr DivergenceFloors kKerasFloors = {.quotient = 1e-7};  // [cornia2018], [kroner2020]
inline constexpr DivergenceFloors kCaffeFloors = {.quotient = 1e-6};  // [liu2018]
inline constexpr DivergenceFloors kPysaliencyFloors = {.values = 1e-20};
inline constexpr DivergenceFloors kShiftedFloors = {.densities = 1e-12};

// Kullback-Leibler divergence of the map from the ground truth by any of these, in nats:
// sum (w/u) (g + d) ln(q + (g + d) / (p + d + q)), p and g the densities of the values + v.
double divergence(std::span<const double> map, std::span<const double> saliency,
                  const DivergenceFloors& floors, Weighting weighting, const Measures& measures);

// Mean of the squared, or the absolute, difference of the normalised values, which may be of negative ones.
// NaN for a constant ground truth, which has no normalised values, unless it is zero.
struct Errors {
  double mse, mae;
};
std::array<Errors, 2> errors(std::span<const double> normalised_map,
                             std::span<const double> normalised_saliency, const Measures& measures);

// A field as a distribution.
struct Distributed {
  std::span<const double> field;  // n
  Density density;

  double at(std::int32_t i) const { return density.of(field[static_cast<std::size_t>(i)]); }
};

// Information gain of p over a baseline b, in bits per pick: mean over the picks of log2(e + p) - log2(e +
// b), e = kDensityFloor. NaN without picks, and where one of the two is no distribution. [kummerer2015]
double information_gain(const Distributed& map, const Distributed& baseline,
                        std::span<const std::int32_t> picked);

}  // namespace salbench
