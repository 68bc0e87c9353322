// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/measure.h"

#include <cmath>
#include <numeric>

#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/metrics/surface_graph.h"

namespace salbench {

Measure vertex_measure(std::size_t n) { return {std::vector<double>(n, 1.0), static_cast<double>(n)}; }

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
  measure.total = sum();
  return measure;
}

Measures Measures::at(std::span<const std::int32_t> points) const {
  const auto some = [&](const ScalarField& field) {
    return field.empty() ? field : values_at(field, points);
  };
  Measures result{points.size(), some(areas), some(centre_bias), some(negatives)};
  if (surface) result.surface = std::make_shared<const SurfaceGraph>(surface->at(points));
  return result;
}

}  // namespace salbench
