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

// Density of a field where it has this value: scale * value + offset. NaN if there is no such distribution.
struct Density {
  double scale = std::numeric_limits<double>::quiet_NaN();
  double offset = 0;

  bool defined() const { return !std::isnan(scale); }
  double of(double value) const { return scale * value + offset; }
};
using Densities = std::array<Density, 2>;  // [weighting]
Densities densities_of_map(std::span<const double> map, const Measures& measures);

struct DensityInput {
  std::span<const double> map, saliency;                        // n; the ground truth as people marked it
  std::span<const double> normalised_map, normalised_saliency;  // min-max
  Densities map_densities;
};

struct DensityScores {
  // Kullback-Leibler divergence of the map from the ground truth, in nats: sum (w/u) g ln(eps + g / (p +
  // eps)), g and p the densities, eps = 2.2204e-16. Per vertex these are the maps scaled to the sum 1.
  // [bylinskii2019]
  double kl;
  // The same of smoothed fields, s + 1e-12 in place of s and no eps: sum (w/u) g ln(g / p). [kummerer2018]
  double kl_smoothed;
  // Similarity, or histogram intersection: sum (w/u) min(p, g); 1 for equal distributions. [judd2012]
  double sim, sim_of_normalised;
};
std::array<DensityScores, 2> density_scores(const DensityInput& in, const Measures& measures);  // [weighting]

// Mean of the squared, or the absolute, difference of the normalised values, which may be of negative ones.
// NaN for a constant ground truth, which has no normalised values, unless it is zero.
struct Errors {
  double mse, mae;
};
std::array<Errors, 2> errors(std::span<const double> normalised_map,
                             std::span<const double> normalised_saliency, const Measures& measures);

// Information gain over the uniform distribution, in bits per pick: mean over the picks of
// log2(eps + p) - log2(eps + u/W), W the total weight. 0 for a constant map, NaN without picks.
// [kummerer2015]
double information_gain(std::span<const double> map, const Density& density,
                        std::span<const std::int32_t> picked, const Measure& measure);

}  // namespace salbench
