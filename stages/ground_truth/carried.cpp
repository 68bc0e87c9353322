// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/ground_truth/carried.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/geometry/neighbours.h"

namespace salbench {
namespace {

constexpr double kUnseen = std::numeric_limits<double>::quiet_NaN();
constexpr double kLargest = std::numeric_limits<double>::max();

}  // namespace

ScalarField vertex_values_of_faces(Points vertices, Surface faces, std::span<const double> values) {
  if (values.size() != faces.size())
    throw ShapeError("there are " + std::to_string(values.size()) + " values for " +
                     std::to_string(faces.size()) + " faces");
  const double scale = scale_to_ordinary(values);
  ScalarField sums(vertices.size()), areas(vertices.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto corner = [&](std::size_t i) { return vertices[static_cast<std::size_t>(faces[f][i])]; };
    const double twice_the_area = (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
    for (const std::int32_t vertex : faces[f]) {
      if (std::isnan(values[f])) continue;
      sums[static_cast<std::size_t>(vertex)] += twice_the_area * (values[f] * scale);
      areas[static_cast<std::size_t>(vertex)] += twice_the_area;
    }
  }
  ScalarField result(vertices.size(), kUnseen);
  for (std::size_t i = 0; i < result.size(); ++i)
    if (areas[i] > 0) result[i] = std::clamp(sums[i] / areas[i] / scale, -kLargest, kLargest);
  return result;
}

ScalarField vertex_values_of_samples(Points vertices, Points samples, std::span<const double> values,
                                     double max_distance) {
  CHECK_EQ(values.size(), samples.size());
  CHECK_GT(samples.size(), 0U);
  const KdTree tree(samples);
  ScalarField result;
  result.reserve(vertices.size());
  for (const Vec3& vertex : vertices) {
    const auto nearest = static_cast<std::size_t>(tree.nearest(vertex));
    result.push_back((samples[nearest] - vertex).norm() <= max_distance ? values[nearest] : kUnseen);
  }
  return result;
}

}  // namespace salbench
