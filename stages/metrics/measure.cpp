// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/measure.h"

#include <cmath>
#include <numeric>
#include <optional>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/metrics/surface_graph.h"

namespace salbench {

Measure vertex_measure(std::size_t n) { return {std::vector<double>(n, 1.0), static_cast<double>(n), 1}; }

Measure area_measure(std::span<const double> areas) {
  Measure measure{{areas.begin(), areas.end()}};
  const auto sum = [&] { return std::accumulate(measure.weight.begin(), measure.weight.end(), 0.0); };
  constexpr int kOrdinary = 40;  // exponents
  if (std::isinf(sum()))         // that of 2^31 finite areas is finite then
    for (double& weight : measure.weight) weight *= 0x1p-40;
  if (!std::isfinite(sum()))
    throw ShapeError("the area around a point is infinite: the coordinates are too large");
  if (const double total = sum(); std::isnormal(total) && std::abs(std::ilogb(total)) > kOrdinary) {
    const double scale = std::ldexp(1, -std::ilogb(total) / 2 * 2);
    for (double& weight : measure.weight) weight *= scale;
  }
  measure.total = measure.unit = sum();
  return measure;
}

Measures::Measures(std::size_t n, std::span<const double> areas, std::span<const double> centre)
    : vertex(vertex_measure(n)),
      area(areas.empty() ? Measure{std::vector<double>(n, 0.0), 0, 0} : area_measure(areas)),
      centre_bias(centre.begin(), centre.end()) {
  CHECK_EQ(area.size(), n);
  if (!centre.empty()) CHECK_EQ(centre.size(), n);
}

Measures Measures::at(std::span<const std::int32_t> points) const {
  const auto of = [&](const ScalarField& field) { return field.empty() ? field : values_at(field, points); };
  Measures some(points.size(), values_at(area.weight, points), of(centre_bias));
  some.negatives = of(negatives);
  if (surface) some.surface = std::make_shared<const SurfaceGraph>(surface->at(points));
  return some;
}

bool is_constant(std::span<const double> field, const Measure& measure) {
  CHECK_EQ(field.size(), measure.size());
  if (measure.empty()) return true;
  std::optional<double> first;
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (!(measure.weight[i] > 0)) continue;
    if (!first) first = field[i];
    if (field[i] != *first) return false;
  }
  return true;
}

}  // namespace salbench
