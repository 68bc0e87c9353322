// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/density.h"

#include <algorithm>
#include <cmath>

#include "stages/core/check.h"
#include "stages/core/field.h"
#include "stages/metrics/measure.h"

namespace salbench {
namespace {

struct Sum {
  double value = 0;
  bool has_negative = false;

  void add(double term, double added) {
    has_negative |= term < 0;
    value += term + added;
  }
};

Sum sum_of(std::span<const double> field, double added) {
  Sum sum;
  for (const double value : field) sum.add(value, added);
  return sum;
}

Density scaled(const Sum& sum, double added) {
  return sum.has_negative ? Density{} : Density{1 / sum.value, added * (1 / sum.value)};
}

// A constant map is valid: all points are equally salient.
Density map_scaled(std::span<const double> map, const Sum& sum, double added) {
  if (map.empty()) return {};
  return is_constant(map) ? Density{0, 1 / static_cast<double>(map.size())} : scaled(sum, added);
}

// Ground truth without any mark is no distribution.
Density truth_scaled(std::span<const double> saliency, const Sum& sum, double added) {
  const bool marked = std::ranges::any_of(saliency, [](double value) { return value != 0; });
  return marked ? scaled(sum, added) : Density{};
}

struct Densities {
  Density map, truth;

  // Both sums are computed in one loop: a single sum would wait for each addition.
  Densities(std::span<const double> map_values, std::span<const double> saliency, double added = 0) {
    Sum of_map, of_truth;
    for (std::size_t i = 0; i < map_values.size(); ++i) {
      of_map.add(map_values[i], added);
      of_truth.add(saliency[i], added);
    }
    map = map_scaled(map_values, of_map, added);
    truth = truth_scaled(saliency, of_truth, added);
  }
  bool defined() const { return map.defined() && truth.defined(); }
};

}  // namespace

Density density_of_map(std::span<const double> map, double added) {
  return map_scaled(map, sum_of(map, added), added);
}

double divergence(std::span<const double> map, std::span<const double> saliency,
                  const DivergenceFloors& floors) {
  CHECK_EQ(map.size(), saliency.size());
  const Densities densities(map, saliency, floors.values);
  if (!densities.defined()) return kUndefined;
  double sum = 0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double p = densities.map.of(map[i]) + floors.densities,
                 g = densities.truth.of(saliency[i]) + floors.densities;
    sum += g * std::log(floors.quotient + g / (p + floors.quotient));
  }
  return sum;
}

double similarity(std::span<const double> map, std::span<const double> saliency) {
  CHECK_EQ(map.size(), saliency.size());
  const Densities densities(map, saliency);
  if (!densities.defined()) return kUndefined;
  double sum = 0;
  for (std::size_t i = 0; i < map.size(); ++i)
    sum += std::min(densities.map.of(map[i]), densities.truth.of(saliency[i]));
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
