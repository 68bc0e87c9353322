// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/moments.h"

#include <cmath>
#include <cstddef>
#include <numeric>

#include "stages/core/check.h"
#include "stages/metrics/measure.h"

namespace salbench {

namespace {

// Equal weights of all points.
struct Ones {
  double operator[](std::size_t) const { return 1; }
};

// True if the field has a single value where the weight is positive, or if no weight is.
template <class Weights>
bool is_constant_where_weighed(std::span<const double> field, const Weights& weights) {
  const double* first = nullptr;
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (!(weights[i] > 0)) continue;
    if (first == nullptr) first = &field[i];
    if (field[i] != *first) return false;
  }
  return true;
}

template <class Weights>
PairMoments pair_moments_by(std::span<const double> a, std::span<const double> b, const Weights& weights,
                            double total) {
  CHECK_EQ(a.size(), b.size());
  double sum_a = 0, sum_b = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum_a += weights[i] * a[i];
    sum_b += weights[i] * b[i];
  }
  const double mean_a = sum_a / total, mean_b = sum_b / total;
  double squares_a = 0, squares_b = 0, products = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double weight = weights[i], from_a = a[i] - mean_a, from_b = b[i] - mean_b;
    squares_a += weight * from_a * from_a;
    squares_b += weight * from_b * from_b;
    products += weight * from_a * from_b;
  }
  const auto moments_of = [&](std::span<const double> field, double mean, double squares) {
    return Moments{mean, squares, std::sqrt(squares / total), is_constant_where_weighed(field, weights)};
  };
  return {moments_of(a, mean_a, squares_a), moments_of(b, mean_b, squares_b), products, total};
}

}  // namespace

PairMoments pair_moments(std::span<const double> a, std::span<const double> b) {
  return pair_moments_by(a, b, Ones(), static_cast<double>(a.size()));
}

PairMoments pair_moments(std::span<const double> a, std::span<const double> b,
                         std::span<const double> weights) {
  CHECK_EQ(a.size(), weights.size());
  return pair_moments_by(a, b, weights, std::accumulate(weights.begin(), weights.end(), 0.0));
}

Moments moments(std::span<const double> field) { return pair_moments(field, field).a; }

double correlation(const PairMoments& pair) {
  if (!(pair.total > 0)) return kUndefined;
  if (pair.a.constant || pair.b.constant) return 0;
  return pair.products / (std::sqrt(pair.a.squares) * std::sqrt(pair.b.squares));
}

double cc(std::span<const double> map, std::span<const double> saliency) {
  return correlation(pair_moments(map, saliency));
}

double nss(std::span<const double> map, std::span<const std::int32_t> picked, const Moments& of_map,
           double constant) {
  if (picked.empty()) return kUndefined;
  if (of_map.constant) return constant;
  double sum = 0;
  for (const std::int32_t i : picked) sum += map[static_cast<std::size_t>(i)] - of_map.mean;
  return sum / (static_cast<double>(picked.size()) * of_map.deviation);
}

double nss(std::span<const double> map, std::span<const std::int32_t> picked, double constant) {
  return nss(map, picked, moments(map), constant);
}

}  // namespace salbench
