// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/core/rng.h"
#include "stages/fitting/bins.h"
#include "stages/geometry/centre.h"
#include "stages/geometry/laplacian.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {
namespace {

using fitting::DistanceBins;
using fitting::ValueBins;

// Where edges are much shorter than a blur is wide, it ends here: of 10 million even points it takes 50,000.
constexpr double kMostBlurSteps = 100'000;
constexpr std::int32_t kManyBlurSteps =
    512;  // more than a mesh of 50,000 points takes: these are made one by one

// Blurs a map by more and more: steps of smoothed_by_steps, each of which has a variance.
class Blur {
 public:
  Blur(FieldView map, Points points, const Adjacency& adjacency)
      : values_(min_max_normalised(map)), adjacency_(adjacency) {
    if (is_constant(values_)) return;
    double squares = 0, joined = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::span<const std::int32_t> ring = adjacency_.of(i);
      joined += ring.empty() ? 0 : 1;
      for (const std::int32_t j : ring)
        squares += (at(points, j) - points[i]).squaredNorm() / (static_cast<double>(ring.size()) + 1);
    }
    const double radius = bounding_radius(points);
    // Variance along one of the two axes of the surface, in R^2, mean over the points that have edges.
    step_ = squares / (2 * joined * radius * radius);
  }

  // Widths ascend from call to call. [0, 1]; a map that is constant, or is so but for rounding, is 0.5.
  ScalarField to(double width) {
    if (is_constant(values_)) return ScalarField(values_.size(), 0.5);
    const double steps = step_ > 0 ? std::round(width * width / step_) : 0;
    const auto wanted = static_cast<std::int32_t>(std::min(steps, kMostBlurSteps));
    if (const std::int32_t more = wanted - std::exchange(done_, wanted); more > kManyBlurSteps)
      values_ = smoothed_by_many_steps(std::move(values_), adjacency_, more);
    else
      values_ = smoothed_by_steps(std::move(values_), adjacency_, more);
    const auto [least, largest] = std::ranges::minmax(values_);
    constexpr double kRounding = 1e-9;
    if (largest - least < kRounding) return ScalarField(values_.size(), 0.5);
    return min_max_normalised(values_);
  }

 private:
  ScalarField values_;
  const Adjacency& adjacency_;
  double step_ = 0;
  std::int32_t done_ = 0;
};

// How much people marked each point, in sum 1; NaN where nobody saw it. None if it says nothing.
ScalarField shares_of_marks(const GroundTruth& truth, std::size_t n) {
  if (!truth.saliency.empty() && truth.saliency.size() != n)
    throw ShapeError("the ground truth has " + std::to_string(truth.saliency.size()) + " values for " +
                     std::to_string(n) + " points");
  for (const auto& participant : truth.picks)
    for (const std::int32_t i : participant)
      if (i < 0 || index(i) >= n)
        throw ShapeError("the ground truth picks point " + std::to_string(i) + " of " + std::to_string(n));
  ScalarField marks = marks_of(truth, n, MarksFrom::picks_first);
  double sum = 0;
  for (const double mark : marks) {
    if (std::isnan(mark)) continue;
    if (!(mark >= 0) || std::isinf(mark)) return {};
    sum += mark;
  }
  if (!(sum > 0)) return {};
  for (double& mark : marks) mark /= sum;
  return marks;
}

}  // namespace

std::int32_t fold_of(const std::string& group, std::int32_t folds, std::uint64_t seed) {
  return static_cast<std::int32_t>(Rng(seed, "folds", group).below(static_cast<std::uint64_t>(folds)));
}

DensityCounts density_counts(FieldView map, Points points, const Adjacency& adjacency,
                             const GroundTruth& truth, std::int32_t fold) {
  DensityCounts counts{.fold = fold};
  const ScalarField marks = shares_of_marks(truth, points.size());
  if (marks.empty()) return counts;
  const ScalarField distances = distances_from_centroid(points);
  const auto seen = std::ranges::count_if(marks, [](double mark) { return !std::isnan(mark); });
  Blur blur(map, points, adjacency);
  for (std::size_t width = 0; width < kBlurWidths.size(); ++width) {
    const ScalarField values = blur.to(kBlurWidths[width]);
    std::map<std::size_t, std::pair<double, double>> shares;  // [cell]: of points, of marks
    for (std::size_t i = 0; i < marks.size(); ++i) {
      if (std::isnan(marks[i])) continue;
      auto& [of_points, of_marks] =
          shares[ValueBins::of(values[i]) * DistanceBins::count + DistanceBins::of(distances[i])];
      of_points += 1 / static_cast<double>(seen);
      of_marks += marks[i];
    }
    for (const auto& [cell, share] : shares) {
      counts.cells.push_back(
          static_cast<std::int32_t>(width * ValueBins::count * DistanceBins::count + cell));
      counts.points.push_back(static_cast<float>(share.first));
      counts.marked.push_back(static_cast<float>(share.second));
    }
  }
  return counts;
}

ScalarField fitted_density(FieldView map, Points points, const Adjacency& adjacency, const DensityFit& fit) {
  if (fit.shapes == 0) return {};
  const ScalarField values = Blur(map, points, adjacency).to(fit.blur);
  ScalarField density = distances_from_centroid(points);
  for (std::size_t i = 0; i < density.size(); ++i)
    density[i] = fitting::linear(fit.value, ValueBins::at(values[i])) +
                 fitting::linear(fit.distance, DistanceBins::at(density[i]));
  const double largest = *std::ranges::max_element(density);
  for (double& value : density)
    value = std::max(std::exp(value - largest), std::numeric_limits<double>::min());
  return density;
}

}  // namespace salbench
