// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/density.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stages/core/check.h"

namespace salbench {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();
constexpr double kEpsilon = 2.2204e-16;  // as the MIT benchmark has it: Matlab's eps to five digits
constexpr double kSmoothing = 1e-12;

// Density of a field at point i: scale * field[i] + offset. NaN everywhere if there is no such distribution.
struct Density {
  std::span<const double> field;
  double scale = kUndefined;
  double offset = 0;

  bool defined() const { return !std::isnan(scale); }
  double operator[](std::size_t i) const { return scale * field[i] + offset; }
};

Density uniform(std::span<const double> field, const Measure& measure) {
  return {field, 0, measure.unit / measure.total};
}

Density normalised(std::span<const double> field, const Measure& measure, double smoothing = 0) {
  CHECK_EQ(field.size(), measure.size());
  double sum = 0;
  bool negative = false;
  for (std::size_t i = 0; i < field.size(); ++i) {
    sum += measure.weight[i] * (field[i] + smoothing);
    negative |= field[i] < 0;
  }
  if (negative || measure.empty()) return {field};
  const double scale = measure.unit / sum;
  return {field, scale, smoothing * scale};
}

// A model may call all points equally salient, and in any number.
Density density_of_map(std::span<const double> map, const Measure& measure, double smoothing = 0) {
  if (!measure.empty() && is_constant(map, measure)) return uniform(map, measure);
  return normalised(map, measure, smoothing);
}

// People who marked nothing say nothing.
Density density_of_truth(std::span<const double> saliency, const Measure& measure, double smoothing = 0) {
  CHECK_EQ(saliency.size(), measure.size());
  for (std::size_t i = 0; i < saliency.size(); ++i)
    if (measure.weight[i] > 0 && saliency[i] != 0) return normalised(saliency, measure, smoothing);
  return {saliency};
}

template <class Term>
double mean_over(const Measure& measure, const Term& term) {
  double sum = 0;
  for (std::size_t i = 0; i < measure.size(); ++i) sum += measure.weight[i] * term(i);
  return sum / measure.total;  // NaN over nothing
}

}  // namespace

double kl(std::span<const double> map, std::span<const double> saliency, const Measure& measure) {
  const Density p = density_of_map(map, measure), g = density_of_truth(saliency, measure);
  if (!p.defined() || !g.defined()) return kUndefined;
  double sum = 0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double truth = g[i];
    // Most of a shape is often marked by nobody; logarithms are what this costs.
    if (truth > 0) sum += measure.weight[i] * truth * std::log(kEpsilon + truth / (p[i] + kEpsilon));
  }
  return sum / measure.unit;
}

double kl_smoothed(std::span<const double> map, std::span<const double> saliency, const Measure& measure) {
  const Density p = density_of_map(map, measure, kSmoothing),
                g = density_of_truth(saliency, measure, kSmoothing);
  if (!p.defined() || !g.defined()) return kUndefined;
  double sum = 0;
  for (std::size_t i = 0; i < map.size(); ++i) sum += measure.weight[i] * g[i] * std::log(g[i] / p[i]);
  return sum / measure.unit;
}

double sim(std::span<const double> map, std::span<const double> saliency, const Measure& measure) {
  const Density p = density_of_map(map, measure), g = density_of_truth(saliency, measure);
  if (!p.defined() || !g.defined()) return kUndefined;
  double sum = 0;
  for (std::size_t i = 0; i < map.size(); ++i) sum += measure.weight[i] * std::min(p[i], g[i]);
  return sum / measure.unit;
}

double mse(std::span<const double> map, std::span<const double> saliency, const Measure& measure) {
  CHECK_EQ(map.size(), saliency.size());
  return mean_over(measure, [&](std::size_t i) { return (map[i] - saliency[i]) * (map[i] - saliency[i]); });
}

double mae(std::span<const double> map, std::span<const double> saliency, const Measure& measure) {
  CHECK_EQ(map.size(), saliency.size());
  return mean_over(measure, [&](std::size_t i) { return std::abs(map[i] - saliency[i]); });
}

double information_gain(std::span<const double> map, std::span<const std::int32_t> picked,
                        const Measure& measure) {
  const Density p = density_of_map(map, measure);
  if (!p.defined() || picked.empty()) return kUndefined;
  const double baseline = std::log2(kEpsilon + measure.unit / measure.total);
  double sum = 0;
  for (const std::int32_t i : picked) sum += std::log2(kEpsilon + p[static_cast<std::size_t>(i)]) - baseline;
  return sum / static_cast<double>(picked.size());
}

}  // namespace salbench
