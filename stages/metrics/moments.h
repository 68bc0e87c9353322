// SPDX-License-Identifier: GPL-3.0-or-later
// Means, deviations and the correlation of fields over a shape.
#pragma once

#include <span>

#include "stages/metrics/measure.h"

namespace salbench {

// Population moments of a field.
struct Moments {
  double mean = 0;
  double squares = 0;  // sum of weight * (value - mean)^2
  double deviation = 0;
  bool constant = false;  // the field has one value: its deviation is rounding, at most
};

// Those of two fields of equal length, and what ties them.
struct PairMoments {
  Moments a, b;
  double products = 0;  // sum of weight * (value of a - mean of a) * (value of b - mean of b)
  double total = 0;     // weight
};
// Over nothing the numbers mean nothing.
PairMoments pair_moments(std::span<const double> a, std::span<const double> b, const Measure& measure);
Moments moments(std::span<const double> field, const Measure& measure);

// Pearson correlation; 0 where one of the two is constant, NaN over nothing.
double correlation(const PairMoments& pair);

// Cosine of the angle between two fields, weighed; NaN where one of the two is zero or the measure is empty.
double cosine(std::span<const double> a, std::span<const double> b, const Measure& measure);

}  // namespace salbench
