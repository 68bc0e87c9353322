// SPDX-License-Identifier: GPL-3.0-or-later
// Means, deviations and the correlation of fields over a shape. Published work counts vertices; on a mesh
// with uneven vertices that gives finely meshed parts more weight, and another mesh of the same surface gets
// other values. Areas are the alternative weights.
#pragma once

#include <cstdint>
#include <span>

namespace salbench {

// Population moments of a field.
struct Moments {
  double mean = 0;
  double squares = 0;  // sum of weight * (value - mean)^2
  double deviation = 0;
  bool constant = false;  // the field has one value: its deviation is only rounding
};

// Moments of two fields of equal length, and their products.
struct PairMoments {
  Moments a, b;
  double products = 0;  // sum of weight * (value of a - mean of a) * (value of b - mean of b)
  double total = 0;     // weight
};
// Undefined without points.
PairMoments pair_moments(std::span<const double> a, std::span<const double> b);
PairMoments pair_moments(std::span<const double> a, std::span<const double> b,
                         std::span<const double> weights);
Moments moments(std::span<const double> field);

// Pearson correlation; 0 if either is constant, NaN without points.
double correlation(const PairMoments& pair);
// The same over the points. [tasse2016]
double cc(std::span<const double> map, std::span<const double> saliency);

// Mean over the picks of the map's distance above its mean, in (population) standard deviations; `constant`
// for a constant map, NaN without picks. [peters2005]
double nss(std::span<const double> map, std::span<const std::int32_t> picked, double constant = 0);
double nss(std::span<const double> map, std::span<const std::int32_t> picked, const Moments& of_map,
           double constant);

}  // namespace salbench
