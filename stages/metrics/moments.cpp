// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/moments.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "stages/core/check.h"

namespace salbench {

PairMoments pair_moments(std::span<const double> a, std::span<const double> b, const Measure& measure) {
  CHECK_EQ(a.size(), measure.size());
  CHECK_EQ(b.size(), measure.size());
  double sum_a = 0, sum_b = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum_a += measure.weight[i] * a[i];
    sum_b += measure.weight[i] * b[i];
  }
  const double mean_a = sum_a / measure.total, mean_b = sum_b / measure.total;
  double squares_a = 0, squares_b = 0, products = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double weight = measure.weight[i], from_a = a[i] - mean_a, from_b = b[i] - mean_b;
    squares_a += weight * from_a * from_a;
    squares_b += weight * from_b * from_b;
    products += weight * from_a * from_b;
  }
  const auto moments_of = [&](std::span<const double> field, double mean, double squares) {
    return Moments{mean, squares, std::sqrt(squares / measure.total), is_constant(field, measure)};
  };
  return {moments_of(a, mean_a, squares_a), moments_of(b, mean_b, squares_b), products, measure.total};
}

Moments moments(std::span<const double> field, const Measure& measure) {
  return pair_moments(field, field, measure).a;
}

double correlation(const PairMoments& pair) {
  if (!(pair.total > 0)) return std::numeric_limits<double>::quiet_NaN();
  if (pair.a.constant || pair.b.constant) return 0;
  return pair.products / (std::sqrt(pair.a.squares) * std::sqrt(pair.b.squares));
}

double cosine(std::span<const double> a, std::span<const double> b, const Measure& measure) {
  // In units of the largest magnitude, so that no square overflows or vanishes.
  const auto unit = [&](std::span<const double> field) {
    double largest = 0;
    for (const double value : field) largest = std::max(largest, std::abs(value));
    return largest;
  };
  const double unit_a = unit(a), unit_b = unit(b);
  double products = 0, squares_a = 0, squares_b = 0;
  for (std::size_t i = 0; i < measure.size(); ++i) {
    const double of_a = a[i] / unit_a, of_b = b[i] / unit_b;
    products += measure.weight[i] * of_a * of_b;
    squares_a += measure.weight[i] * of_a * of_a;
    squares_b += measure.weight[i] * of_b * of_b;
  }
  return products / (std::sqrt(squares_a) * std::sqrt(squares_b));
}

}  // namespace salbench
