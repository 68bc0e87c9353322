// SPDX-License-Identifier: GPL-3.0-or-later
// A sum in the order of the points waits for each addition before the next one; two in one loop wait
// together.
#include "stages/metrics/moments.h"

#include <cmath>
#include <cstddef>
#include <limits>

#include "stages/core/check.h"

namespace salbench {

PairMoments pair_moments(std::span<const double> a, std::span<const double> b, const Measure& measure) {
  CHECK_EQ(a.size(), b.size());
  PairMoments pair{.a = {.constant = is_constant(a, measure)},
                   .b = {.constant = is_constant(b, measure)},
                   .total = measure.total};
  double sum_a = 0, sum_b = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double weight = measure.weight[i];
    sum_a += weight * a[i];
    sum_b += weight * b[i];
  }
  const double mean_a = pair.a.mean = sum_a / measure.total;
  const double mean_b = pair.b.mean = sum_b / measure.total;
  double squares_a = 0, squares_b = 0, products = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double weight = measure.weight[i], from_a = a[i] - mean_a, from_b = b[i] - mean_b;
    squares_a += weight * from_a * from_a;
    squares_b += weight * from_b * from_b;
    products += weight * from_a * from_b;
  }
  pair.a.squares = squares_a;
  pair.b.squares = squares_b;
  pair.products = products;
  for (Moments* of : {&pair.a, &pair.b}) of->deviation = std::sqrt(of->squares / measure.total);
  return pair;
}

Moments moments(std::span<const double> field, const Measure& measure) {
  return pair_moments(field, field, measure).a;
}

double correlation(const PairMoments& pair) {
  if (!(pair.total > 0)) return std::numeric_limits<double>::quiet_NaN();
  if (pair.a.constant || pair.b.constant) return 0;
  return pair.products / (std::sqrt(pair.a.squares) * std::sqrt(pair.b.squares));
}

}  // namespace salbench
