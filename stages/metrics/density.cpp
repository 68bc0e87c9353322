// SPDX-License-Identifier: GPL-3.0-or-later
// All scores in two passes over the points, one for the sums that densities are scaled by: a sum in the order
// of the points waits for each addition, and those of one pass wait together.
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

// What a density is scaled by.
struct WeighedSum {
  double smoothing = 0;
  double sum = 0;
  bool negative = false;  // a value

  void add(double weight, double value) {
    sum += weight * (value + smoothing);
    negative |= value < 0;
  }
};

Density scaled_by(const WeighedSum& weighed, const Measure& measure) {
  if (weighed.negative || measure.empty()) return {};
  const double scale = measure.unit / weighed.sum;
  return {scale, weighed.smoothing * scale};
}

// A model may call all points equally salient, and in any number.
Density of_map(std::span<const double> map, const WeighedSum& weighed, const Measure& measure) {
  if (!measure.empty() && is_constant(map, measure)) return {0, measure.unit / measure.total};
  return scaled_by(weighed, measure);
}

// People who marked nothing say nothing.
Density of_truth(std::span<const double> saliency, const WeighedSum& weighed, const Measure& measure) {
  for (std::size_t i = 0; i < saliency.size(); ++i)
    if (measure.weight[i] > 0 && saliency[i] != 0) return scaled_by(weighed, measure);
  return {};
}

// Of map and ground truth.
struct Densities {
  Density p, g;

  double value_if_defined(double value) const { return p.defined() && g.defined() ? value : kUndefined; }
};

struct AllDensities {
  Densities raw, smoothed, normalised;
};

AllDensities densities_of(const DensityInput& in, const Measure& measure) {
  WeighedSum smoothed_map{kSmoothing}, smoothed_saliency{kSmoothing}, saliency, normalised_map,
      normalised_saliency;
  for (std::size_t i = 0; i < measure.size(); ++i) {
    const double weight = measure.weight[i];
    smoothed_map.add(weight, in.map[i]);
    saliency.add(weight, in.saliency[i]);
    smoothed_saliency.add(weight, in.saliency[i]);
    normalised_map.add(weight, in.normalised_map[i]);
    normalised_saliency.add(weight, in.normalised_saliency[i]);
  }
  return {{in.map_density, of_truth(in.saliency, saliency, measure)},
          {of_map(in.map, smoothed_map, measure), of_truth(in.saliency, smoothed_saliency, measure)},
          {of_map(in.normalised_map, normalised_map, measure),
           of_truth(in.normalised_saliency, normalised_saliency, measure)}};
}

}  // namespace

Density density_of_map(std::span<const double> map, const Measure& measure) {
  CHECK_EQ(map.size(), measure.size());
  WeighedSum weighed;
  for (std::size_t i = 0; i < map.size(); ++i) weighed.add(measure.weight[i], map[i]);
  return of_map(map, weighed, measure);
}

DensityScores density_scores(const DensityInput& in, const Measure& measure) {
  for (const auto& field : {in.map, in.saliency, in.normalised_map, in.normalised_saliency})
    CHECK_EQ(field.size(), measure.size());
  const auto [raw, smoothed, normalised] = densities_of(in, measure);
  double kl = 0, kl_smoothed = 0, sim = 0, sim_of_normalised = 0, squares = 0, magnitudes = 0;
  for (std::size_t i = 0; i < measure.size(); ++i) {
    const double weight = measure.weight[i], map = in.map[i], saliency = in.saliency[i];
    const double p = raw.p.of(map), g = raw.g.of(saliency);
    // Most of a shape is often marked by nobody; logarithms are what this costs.
    if (g > 0) kl += weight * g * std::log(kEpsilon + g / (p + kEpsilon));
    sim += weight * std::min(p, g);
    const double smoothed_p = smoothed.p.of(map), smoothed_g = smoothed.g.of(saliency);
    kl_smoothed += weight * smoothed_g * std::log(smoothed_g / smoothed_p);
    const double map_to_1 = in.normalised_map[i], saliency_to_1 = in.normalised_saliency[i];
    sim_of_normalised += weight * std::min(normalised.p.of(map_to_1), normalised.g.of(saliency_to_1));
    const double difference = map_to_1 - saliency_to_1;
    squares += weight * (difference * difference);
    magnitudes += weight * std::abs(difference);
  }
  const double unit = measure.unit, total = measure.total;
  return {.kl = raw.value_if_defined(kl / unit),
          .kl_smoothed = smoothed.value_if_defined(kl_smoothed / unit),
          .sim = raw.value_if_defined(sim / unit),
          .sim_of_normalised = normalised.value_if_defined(sim_of_normalised / unit),
          .mse = squares / total,  // NaN over nothing
          .mae = magnitudes / total};
}

double information_gain(std::span<const double> map, const Density& density,
                        std::span<const std::int32_t> picked, const Measure& measure) {
  if (!density.defined() || picked.empty()) return kUndefined;
  const double baseline = std::log2(kEpsilon + measure.unit / measure.total);
  double sum = 0;
  for (const std::int32_t i : picked)
    sum += std::log2(kEpsilon + density.of(map[static_cast<std::size_t>(i)])) - baseline;
  return sum / static_cast<double>(picked.size());
}

}  // namespace salbench
