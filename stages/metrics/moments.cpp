// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/moments.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "stages/core/check.h"

namespace salbench {

std::array<PairMoments, 2> pair_moments(const WeighedField& a, const WeighedField& b,
                                        const Measures& measures) {
  const std::size_t n = measures.size();
  for (const WeighedField* field : {&a, &b})
    for (const auto& values : {field->by_vertex, field->by_area}) CHECK_EQ(values.size(), n);
  const PerWeighting total(measures.vertex.total, measures.area.total);
  PerWeighting sum_a(0, 0), sum_b(0, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const PerWeighting weight = measures.weight(i);
    sum_a += weight * a[i];
    sum_b += weight * b[i];
  }
  const PerWeighting mean_a = sum_a / total, mean_b = sum_b / total;
  PerWeighting squares_a(0, 0), squares_b(0, 0), products(0, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const PerWeighting weight = measures.weight(i), from_a = a[i] - mean_a, from_b = b[i] - mean_b;
    squares_a += weight * from_a * from_a;
    squares_b += weight * from_b * from_b;
    products += weight * from_a * from_b;
  }
  const auto of = [&](Weighting weighting) {
    const auto k = static_cast<Eigen::Index>(weighting);
    const auto moments_of = [&](const WeighedField& field, double mean, double squares) {
      return Moments{mean, squares, std::sqrt(squares / total[k]),
                     is_constant(field[weighting], measures[weighting])};
    };
    return PairMoments{moments_of(a, mean_a[k], squares_a[k]), moments_of(b, mean_b[k], squares_b[k]),
                       products[k], total[k]};
  };
  return {of(Weighting::vertex), of(Weighting::area)};
}

std::array<Moments, 2> moments(std::span<const double> field, const Measures& measures) {
  const auto pair = pair_moments(alike(field), alike(field), measures);
  return {pair[0].a, pair[1].a};
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
