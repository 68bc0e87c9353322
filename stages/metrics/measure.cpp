// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/measure.h"

#include "stages/core/field.h"
#include "stages/metrics/surface_graph.h"

namespace salbench {

Measures Measures::at(std::span<const std::int32_t> points) const {
  const auto some = [&](const ScalarField& field) {
    return field.empty() ? field : values_at(field, points);
  };
  Measures result{points.size(), some(areas), some(centre_bias), some(negatives)};
  if (surface) result.surface = std::make_shared<const SurfaceGraph>(surface->at(points));
  return result;
}

}  // namespace salbench
