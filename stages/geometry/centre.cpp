// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/centre.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/core/seen.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {
namespace {

std::size_t bin_of(double distance) {
  return std::min(static_cast<std::size_t>(distance * kCentreBins), std::size_t{kCentreBins - 1});
}

// Marks on each of n points: the saliency, or the number of picks if it is unknown. NaN if unseen. Picks
// outside of the n points are ignored.
ScalarField marks_of(const GroundTruth& truth, std::size_t n) {
  ScalarField marks = truth.saliency;
  if (marks.empty()) {
    marks.resize(n);
    for (const auto& participant : truth.picks)
      for (const std::int32_t i : participant)
        if (i >= 0 && index(i) < n) ++marks[index(i)];
  }
  return marks;
}

}  // namespace

ScalarField distances_from_centroid(Points points) {
  ScalarField distances;
  distances.reserve(points.size());
  for (const Vec3& p : in_units_of_radius(points)) distances.push_back(std::min(p.norm(), 1.0));
  return distances;
}

CentreDensity centre_density(Points points, const GroundTruth& truth) {
  const ScalarField distances = distances_from_centroid(points);
  const ScalarField marks = marks_of(truth, points.size());
  if (marks.size() != points.size())
    throw ShapeError("the ground truth has " + std::to_string(marks.size()) + " values for " +
                     std::to_string(points.size()) + " points");
  CentreDensity density;
  double total = 0, seen = 0;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (std::isnan(marks[i])) continue;
    if (!(marks[i] >= 0) || std::isinf(marks[i])) return {};
    const std::size_t bin = bin_of(distances[i]);
    density.marked[bin] += marks[i];
    density.points[bin] += 1;
    total += marks[i];
    seen += 1;
  }
  if (!(total > 0)) return {};
  for (double& share : density.marked) share /= total;
  for (double& share : density.points) share /= seen;
  density.shapes = 1;
  return density;
}

void add(CentreDensity& sum, const CentreDensity& shape) {
  for (std::size_t bin = 0; bin < kCentreBins; ++bin) {
    sum.marked[bin] += shape.marked[bin];
    sum.points[bin] += shape.points[bin];
  }
  sum.shapes += shape.shapes;
}

// A sum of non-negative terms is never less than one of them, even after rounding: differences are not
// negative, and are 0 where the other terms are.
ScalarField density_of_others(Points points, const CentreDensity& own, const CentreDensity& set) {
  if (set.shapes <= own.shapes) return {};
  std::array<double, kCentreBins> density{};
  for (std::size_t bin = 0; bin < kCentreBins; ++bin)
    if (const double of_points = set.points[bin] - own.points[bin]; of_points > 0)
      density[bin] = (set.marked[bin] - own.marked[bin]) / of_points;
  ScalarField values = distances_from_centroid(points);
  for (double& value : values) value = density[bin_of(value)];
  return values;
}

}  // namespace salbench
