// SPDX-License-Identifier: GPL-3.0-or-later
// Scores of points with every property of a shape that a metric may read.
#pragma once

#include <cmath>
#include <memory>

#include "stages/metrics/score.h"
#include "stages/metrics/surface_graph.h"

namespace salbench {

// A strip of triangles along a helix.
inline SurfaceGraph strip(std::size_t n) {
  std::vector<Vec3> points;
  Faces faces;
  for (std::size_t i = 0; i < n; ++i) {
    const auto k = static_cast<double>(i);
    points.push_back({std::cos(k / 3), std::sin(k / 3), k / 10});
    if (i >= 2)
      faces.push_back(
          {static_cast<std::int32_t>(i - 2), static_cast<std::int32_t>(i - 1), static_cast<std::int32_t>(i)});
  }
  return surface_graph(points, faces);
}

inline Measures complete_measures(std::size_t n, const ScalarField& areas, const ScalarField& centre_bias) {
  Measures measures{.size = n, .areas = areas, .centre_bias = centre_bias};
  for (std::size_t i = 0; i < n; ++i) measures.negatives.push_back(static_cast<double>(1 + i % 3));
  measures.surface = std::make_shared<const SurfaceGraph>(strip(n));
  return measures;
}

}  // namespace salbench
