// SPDX-License-Identifier: GPL-3.0-or-later
// Sums over simplified histograms (spfh.h). Differences from the original publication are those of PCL and of
// the benchmark's authors: absolute values of the three features, and the weights listed in FpfhWeighting.
// Bins that absolute values never fill are omitted until the end.
#include "stages/descriptors/fpfh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/core/parallel.h"
#include "stages/descriptors/neighbourhoods.h"
#include "stages/descriptors/spfh.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {
namespace {

constexpr double kBlockTotal = 100;  // sum of each block in the published weighting
constexpr double kMaxWeight = 1e12;  // limit of R / distance: smaller distances are rounding errors

using Sums = std::array<double, kSpfhBins>;

// Weights are relative to that of the nearest neighbour, which cancels in the scaling and prevents overflow.
void combine_published(std::span<const Neighbour> neighbours, const SimplifiedHistograms& spfh, Sums& sum) {
  const auto apart = std::ranges::find_if(neighbours, [](const Neighbour& n) { return !n.coincides(); });
  for (auto n = apart; n != neighbours.end(); ++n) {
    const double weight = apart->distance_squared / n->distance_squared;
    const float* row = spfh.of(n->index);
    for (std::size_t b = 0; b < kSpfhBins; ++b) sum[b] += weight * static_cast<double>(row[b]);
  }
  for (std::size_t block = 0; block < kSpfhBins; block += kFilledBins) {
    const auto first = sum.begin() + static_cast<std::ptrdiff_t>(block);
    const double total = std::accumulate(first, first + kFilledBins, 0.0);
    if (total == 0) continue;
    std::for_each_n(first, kFilledBins, [&](double& value) { value *= kBlockTotal / total; });
  }
}

void combine_text(std::int32_t point, double unit, std::span<const Neighbour> neighbours, std::size_t others,
                  const SimplifiedHistograms& spfh, Sums& sum) {
  const float* own = spfh.of(point);
  const double count = vote_divisor(others);
  for (std::size_t b = 0; b < kSpfhBins; ++b) sum[b] = static_cast<double>(own[b]);
  for (const Neighbour& n : neighbours) {
    if (n.coincides()) continue;
    const double weight = std::min(unit / std::sqrt(n.distance_squared), kMaxWeight) / count;
    const float* row = spfh.of(n.index);
    for (std::size_t b = 0; b < kSpfhBins; ++b) sum[b] += weight * static_cast<double>(row[b]);
  }
}

// Points whose SPFH is needed, ascending: the neighbours of the subset and, unless only neighbours count, the
// subset itself.
std::vector<std::int32_t> needed(std::size_t n, std::span<const std::int32_t> subset,
                                 const Neighbourhoods& neighbourhoods, bool neighbours_only) {
  if (subset.size() == n && (neighbourhoods.all_points() || !neighbours_only))
    return {subset.begin(), subset.end()};
  std::vector<bool> taken(n, false);
  Neighbourhoods::Memory memory;
  for (const std::int32_t i : subset) {
    if (!neighbours_only) taken[static_cast<std::size_t>(i)] = true;
    for (const Neighbour& neighbour : neighbourhoods.unordered(i, memory))
      taken[static_cast<std::size_t>(neighbour.index)] = true;
  }
  std::vector<std::int32_t> points;
  for (std::size_t i = 0; i < n; ++i)
    if (taken[i]) points.push_back(static_cast<std::int32_t>(i));
  return points;
}

void check_normals(std::span<const Vec3> points, std::span<const Vec3> normals) {
  CHECK_EQ(points.size(), normals.size());
  const auto bad = std::ranges::find_if_not(normals, [](const Vec3& n) { return n.allFinite(); });
  if (bad != normals.end())
    throw ShapeError("the normal of point " + std::to_string(bad - normals.begin()) +
                     " (0-based) is not finite");
}

Support support_of(std::span<const Vec3> points, const KdTree& tree, const FpfhOptions& options) {
  if (options.neighbourhood == FpfhNeighbourhood::nearest) return {options.neighbours, 0};
  if (options.grow)
    return {0, grown_support_radius(points, tree, options.radius, options.grown_neighbours).radius};
  const double radius = options.radius * bounding_radius(points);
  require_few_neighbours(points, tree, radius);
  return {0, radius};
}

}  // namespace

Descriptors fpfh(std::span<const Vec3> points, std::span<const Vec3> normals, const KdTree& tree,
                 const Support& support, FpfhWeighting weighting, std::span<const std::int32_t> subset) {
  check_normals(points, normals);
  const Neighbourhoods neighbourhoods(points, tree, support);
  const bool published = weighting == FpfhWeighting::published;
  const SimplifiedHistograms spfh(points, normals, needed(points.size(), subset, neighbourhoods, published),
                                  neighbourhoods, published);

  const double unit = published ? 1 : bounding_radius(points);
  Descriptors result{std::vector<float>(subset.size() * kFpfhBins), support.radius, support.neighbours};
  parallel_ranges(subset.size(), kPointGrain, [&](std::size_t first, std::size_t last) {
    Neighbourhoods::Memory memory;
    for (std::size_t i = first; i < last; ++i) {
      Sums sum{};
      const auto neighbours = neighbourhoods.of(subset[i], memory);
      if (published)
        combine_published(neighbours, spfh, sum);
      else
        combine_text(subset[i], unit, neighbours, neighbourhoods.others(subset[i], neighbours), spfh, sum);
      for (std::size_t b = 0; b < kSpfhBins; ++b)
        result.values[i * kFpfhBins + b / kFilledBins * kBlockBins + kFirstFilled + b % kFilledBins] =
            static_cast<float>(sum[b]);
    }
  });
  return result;
}

Descriptors fpfh(std::span<const Vec3> points, std::span<const Vec3> normals, const KdTree& tree,
                 const Support& support, FpfhWeighting weighting) {
  std::vector<std::int32_t> all(points.size());
  std::iota(all.begin(), all.end(), 0);
  return fpfh(points, normals, tree, support, weighting, all);
}

Descriptors fpfh(std::span<const Vec3> points, std::span<const Vec3> normals, const FpfhOptions& options) {
  check(options);
  if (points.empty()) throw ShapeError("the shape has no points");
  require_finite(points);
  const KdTree tree(points);
  return fpfh(points, normals, tree, support_of(points, tree, options), options.weighting);
}

}  // namespace salbench
