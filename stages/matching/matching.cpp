// SPDX-License-Identifier: GPL-3.0-or-later
// A piecewise-linear map of values through two binned cumulative densities, not a rank transform: equal to
// the benchmark authors' program to the last published digit.
#include "stages/matching/matching.h"

#include <algorithm>
#include <array>

#include "stages/core/field.h"

namespace salbench {
namespace {

using Edges = std::array<double, kHistogramBins + 1>;

// [0, cumsum(density)]; the bins on either side of the matching have equal width, which cancels.
Edges cumulative(const Histogram& density) {
  Edges sums{};
  for (std::size_t i = 0; i < kHistogramBins; ++i) sums[i + 1] = sums[i] + density[i];
  return sums;
}

// Piecewise linear interpolation of the points (from, to), clamped at both ends. `from` ascends; the last of
// equal entries applies.
double interpolated(double x, const Edges& from, const Edges& to) {
  if (x < from.front()) return to.front();
  if (x >= from.back()) return to.back();
  const auto above = static_cast<std::size_t>(std::ranges::upper_bound(from, x) - from.begin());
  const std::size_t below = above - 1;
  return to[below] + (to[above] - to[below]) * ((x - from[below]) / (from[above] - from[below]));
}

}  // namespace

Histogram normalised_histogram(std::span<const double> field) {
  return binned_density(min_max_normalised(field)).density;
}

Histogram mean_histogram(std::span<const Histogram> histograms) {
  Histogram mean{};
  for (const Histogram& histogram : histograms)
    for (std::size_t i = 0; i < kHistogramBins; ++i)
      mean[i] += histogram[i] / static_cast<double>(histograms.size());
  return mean;
}

ScalarField matched(std::span<const double> map, const Histogram& reference) {
  ScalarField values = min_max_normalised(map);
  if (is_constant(values)) return values;
  const BinnedDensity own = binned_density(values);
  const Edges own_cumulative = cumulative(own.density);
  const Edges reference_cumulative = cumulative(reference);
  Edges moved{};
  std::ranges::transform(own_cumulative, moved.begin(),
                         [&](double c) { return interpolated(c, reference_cumulative, own.edges); });
  for (double& value : values) value = interpolated(value, own.edges, moved);
  return min_max_normalised(values);
}

}  // namespace salbench
