// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/density.h"

#include <algorithm>
#include <cmath>

#include "stages/core/field.h"
#include "stages/metrics/measure.h"

namespace salbench {
namespace {

Density scaled(std::span<const double> field, double added) {
  if (std::ranges::any_of(field, [](double value) { return value < 0; })) return {};
  double sum = 0;
  for (const double value : field) sum += value + added;
  return {1 / sum, added * (1 / sum)};
}

}  // namespace

// A model may call all points equally salient, and in any number.
Density density_of_map(std::span<const double> map, double added) {
  if (map.empty()) return {};
  return is_constant(map) ? Density{0, 1 / static_cast<double>(map.size())} : scaled(map, added);
}

// People who marked nothing say nothing.
Density density_of_truth(std::span<const double> saliency, double added) {
  const bool marked = std::ranges::any_of(saliency, [](double value) { return value != 0; });
  return marked ? scaled(saliency, added) : Density{};
}

double divergence(std::span<const double> map, std::span<const double> saliency,
                  const DivergenceFloors& floors) {
  const Density of_map = density_of_map(map, floors.values);
  const Density of_truth = density_of_truth(saliency, floors.values);
  if (!of_map.defined() || !of_truth.defined()) return kUndefined;
  double sum = 0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double p = of_map.of(map[i]) + floors.densities, g = of_truth.of(saliency[i]) + floors.densities;
    sum += g * std::log(floors.quotient + g / (p + floors.quotient));
  }
  return sum;
}

double similarity(std::span<const double> map, std::span<const double> saliency) {
  const Density of_map = density_of_map(map), of_truth = density_of_truth(saliency);
  if (!of_map.defined() || !of_truth.defined()) return kUndefined;
  double sum = 0;
  for (std::size_t i = 0; i < map.size(); ++i) sum += std::min(of_map.of(map[i]), of_truth.of(saliency[i]));
  return sum;
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
