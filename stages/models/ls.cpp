// SPDX-License-Identifier: GPL-3.0-or-later
// Shtrom, Leifman and Tal 2013, as the benchmark's authors ran it. Unlike the publication, a point is
// compared only with the points most similar to it, and the high level recomputes only the descriptors of the
// most distinct points, which are compared with all others' low-level ones. LsOptions::text() is the model as
// the paper describes it.
#include "stages/models/ls.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "stages/core/check.h"
#include "stages/core/parallel.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/geometry/neighbours.h"
#include "stages/geometry/support.h"
#include "stages/models/chi2_search.h"

namespace salbench {
namespace {

constexpr double kHistogramTotal = 300;  // sum of a descriptor in the published weighting: 3 blocks of 100

std::size_t count_of(double share, std::size_t n) {
  return static_cast<std::size_t>(share * static_cast<double>(n));
}

// The `count` points with the largest values, ascending; ties go to the higher index.
std::vector<std::int32_t> largest(const ScalarField& field, std::size_t count) {
  std::vector<std::int32_t> points(field.size());
  std::iota(points.begin(), points.end(), 0);
  const auto rank = [&](std::int32_t i) { return std::pair(field[static_cast<std::size_t>(i)], i); };
  std::nth_element(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count), points.end(),
                   [&](std::int32_t a, std::int32_t b) { return rank(a) > rank(b); });
  points.resize(count);
  std::ranges::sort(points);
  return points;
}

// Empty: all points.
std::vector<std::int32_t> sample_of(std::span<const Vec3> points, const LsOptions& options) {
  const auto most = static_cast<std::size_t>(options.sample);
  return points.size() > most ? KdTree(points).even_sample(most) : std::vector<std::int32_t>();
}

// 1 - exp(-mean dissimilarity to the selected points), with chi2 weighted by the distance. `kth` as in
// weighted_sums().
ScalarField distinctness(std::span<const Vec3> points, const Descriptors& descriptors,
                         std::span<const std::int32_t> sample, double selected_share,
                         chi2_kernel::Weight weight, std::vector<float>& kth) {
  const Chi2Search search(descriptors, sample);
  const std::size_t selected = std::max<std::size_t>(count_of(selected_share, search.size()), 1);
  ScalarField result = weighted_sums(search, selected, points, weight, kth);
  for (double& value : result)
    value = 1 - std::exp(-value / (kHistogramTotal * static_cast<double>(selected)));
  return result;
}

// Distinctness of the nearest focus, decreasing with the distance from it.
ScalarField association(std::span<const Vec3> points, const ScalarField& low, const LsOptions& options) {
  const std::size_t count = std::max<std::size_t>(count_of(options.foci_share, points.size()), 1);
  const std::vector<std::int32_t> foci = largest(low, count);
  std::vector<Vec3> places;
  places.reserve(foci.size());
  for (const std::int32_t focus : foci) places.push_back(points[static_cast<std::size_t>(focus)]);
  const KdTree tree(places);

  const double twice_variance = 2 * options.foci_sigma * options.foci_sigma;
  ScalarField result(points.size());
  parallel_ranges(points.size(), kPointGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const auto nearest = static_cast<std::size_t>(tree.nearest(points[i]));
      result[i] = low[static_cast<std::size_t>(foci[nearest])] *
                  std::exp(-(points[i] - places[nearest]).squaredNorm() / twice_variance);
    }
  });
  return result;
}

// The low-level descriptors, except that the most distinct points have high-level ones.
Descriptors mixed_descriptors(Points points, const Normals& normals, const Descriptors& low_level,
                              const std::vector<std::int32_t>& distinct,
                              const std::vector<std::int32_t>& sample, const LsOptions& options) {
  const Support support{0, options.high_radius * bounding_radius(points)};
  const KdTree around = sample.empty() ? KdTree(points) : KdTree(points, sample);
  require_few_neighbours(points, around, support.radius);
  const Descriptors high = fpfh(points, normals, around, support, options.high_weighting, distinct);
  Descriptors mixed = low_level;
  for (std::size_t h = 0; h < distinct.size(); ++h) {
    const auto row = high.row(h);
    std::ranges::copy(row, mixed.values.begin() + static_cast<std::ptrdiff_t>(distinct[h]) * kFpfhBins);
  }
  return mixed;
}

}  // namespace

LsOptions LsOptions::of_meshes() const {
  LsOptions options = *this;
  options.selected_share_of_scans = 0;
  return options;
}

LsOptions LsOptions::of_scans() const {
  LsOptions options = of_meshes();
  if (selected_share_of_scans > 0) options.selected_share = selected_share_of_scans;
  return options;
}

LsOptions LsOptions::text() {
  // S = (D_low + D_high) / 2 + A / 2: the halves are a common factor.
  LsOptions options;
  options.selected_share = 1;
  options.selected_share_of_scans = 0;
  options.high_share = 1;
  options.high_weighting = FpfhWeighting::text;
  options.high_weight = 1;
  return options;
}

ScalarField ls_saliency(Points points, const Normals& normals, const Descriptors& fpfh,
                        const LsOptions& options) {
  check(options);
  CHECK_EQ(fpfh.size(), points.size());
  CHECK_EQ(normals.size(), points.size());
  const std::vector<Vec3> places = in_units_of_radius(points);

  // Near points are weighted more at the low level, far ones at the high level.
  const std::vector<std::int32_t> sample = sample_of(places, options);
  std::vector<float> kth;
  const ScalarField low =
      distinctness(places, fpfh, sample, options.selected_share, chi2_kernel::Weight::near, kth);
  ScalarField saliency = association(places, low, options);

  // Most points keep their descriptors, and so do most of the points similar to them.
  const std::vector<std::int32_t> distinct = largest(low, count_of(options.high_share, low.size()));
  for (const std::int32_t i : distinct) kth[static_cast<std::size_t>(i)] = 0;
  const ScalarField high =
      distinctness(places, mixed_descriptors(points, normals, fpfh, distinct, sample, options), sample,
                   options.selected_share, chi2_kernel::Weight::far, kth);
  for (std::size_t i = 0; i < saliency.size(); ++i) saliency[i] += low[i] + options.high_weight * high[i];
  return saliency;
}

}  // namespace salbench
