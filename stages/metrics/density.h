// SPDX-License-Identifier: GPL-3.0-or-later
// Distances and similarities of two fields over a shape, most of them as distributions of saliency.
//
// A distribution has p_i = w_i s_i / sum(w s) at point i; its density is d_i = s_i u / sum(w s), per vertex
// (u = 1) or relative to a uniform one (by area, u = the whole area): Measure::unit. A field that is
// constant, zero included, is the uniform distribution. Everything is NaN over nothing (an empty measure),
// where a value is negative, and where the ground truth is zero everywhere.
#pragma once

#include <cstdint>
#include <span>

#include "stages/metrics/measure.h"

namespace salbench {

// Kullback-Leibler divergence of the map from the ground truth, in nats: sum (w/u) g ln(eps + g / (p + eps)),
// g and p the densities, eps = 2.2204e-16. Per vertex these are the maps scaled to the sum 1. [bylinskii2019]
double kl(std::span<const double> map, std::span<const double> saliency, const Measure& measure);

// The same of smoothed fields, s + 1e-12 in place of s and no eps: sum (w/u) g ln(g / p). [kummerer2018]
double kl_smoothed(std::span<const double> map, std::span<const double> saliency, const Measure& measure);

// Similarity, or histogram intersection: sum (w/u) min(p, g); 1 for equal distributions. [judd2012]
double sim(std::span<const double> map, std::span<const double> saliency, const Measure& measure);

// Mean of the squared, or the absolute, difference of the values. NaN over nothing.
double mse(std::span<const double> map, std::span<const double> saliency, const Measure& measure);
double mae(std::span<const double> map, std::span<const double> saliency, const Measure& measure);

// Information gain over the uniform distribution, in bits per pick: mean over the picks of
// log2(eps + p) - log2(eps + u/W), W the total weight. 0 for a constant map, NaN without picks.
// [kummerer2015]
double information_gain(std::span<const double> map, std::span<const std::int32_t> picked,
                        const Measure& measure);

}  // namespace salbench
