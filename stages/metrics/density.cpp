// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/density.h"

#include <algorithm>
#include <cmath>

#include "stages/core/check.h"
#include "stages/core/field.h"

namespace salbench {
namespace {

Density scaled(std::span<const double> field, const Measure& measure, double added) {
  CHECK_EQ(field.size(), measure.size());
  if (std::ranges::any_of(field, [](double value) { return value < 0; })) return {};
  double sum = 0;
  for (std::size_t i = 0; i < field.size(); ++i) sum += measure.weight[i] * (field[i] + added);
  return {measure.unit / sum, added * (measure.unit / sum)};
}

}  // namespace

// A model may call all points equally salient, and in any number.
Density density_of_map(std::span<const double> map, const Measure& measure, double added) {
  if (measure.empty()) return {};
  return is_constant(map, measure) ? Density{0, measure.unit / measure.total} : scaled(map, measure, added);
}

// People who marked nothing say nothing.
Density density_of_truth(std::span<const double> saliency, const Measure& measure, double added) {
  for (std::size_t i = 0; i < saliency.size(); ++i)
    if (measure.weight[i] > 0 && saliency[i] != 0) return scaled(saliency, measure, added);
  return {};
}

double divergence(std::span<const double> map, std::span<const double> saliency,
                  const DivergenceFloors& floors, const Measure& measure) {
  const Density of_map = density_of_map(map, measure, floors.values);
  const Density of_truth = density_of_truth(saliency, measure, floors.values);
  if (!of_map.defined() || !of_truth.defined()) return kUndefined;
  double sum = 0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double p = of_map.of(map[i]) + floors.densities, g = of_truth.of(saliency[i]) + floors.densities;
    sum += measure.weight[i] * g * std::log(floors.quotient + g / (p + floors.quotient));
  }
  return sum / measure.unit;
}

double similarity(std::span<const double> map, std::span<const double> saliency, const Measure& measure) {
  const Density of_map = density_of_map(map, measure), of_truth = density_of_truth(saliency, measure);
  if (!of_map.defined() || !of_truth.defined()) return kUndefined;
  double sum = 0;
  for (std::size_t i = 0; i < map.size(); ++i)
    sum += measure.weight[i] * std::min(of_map.of(map[i]), of_truth.of(saliency[i]));
  return sum / measure.unit;
}

double mean_error(std::span<const double> normalised_map, std::span<const double> normalised_saliency,
                  double (*error)(double difference), const Measure& measure) {
  if (is_constant(normalised_saliency) && normalised_saliency[0] != 0) return kUndefined;
  double sum = 0;
  for (std::size_t i = 0; i < measure.size(); ++i)
    sum += measure.weight[i] * error(normalised_map[i] - normalised_saliency[i]);
  return sum / measure.total;  // NaN over nothing
}

double information_gain(const Distributed& map, const Distributed& baseline,
                        std::span<const std::int32_t> picked) {
  if (!map.density.defined() || !baseline.density.defined() || picked.empty()) return kUndefined;
  double sum = 0;
  for (const std::int32_t i : picked)
    sum += std::log2(kDensityFloor + map.at(i)) - std::log2(kDensityFloor + baseline.at(i));
  return sum / static_cast<double>(picked.size());
}

}  // namespace salbench
