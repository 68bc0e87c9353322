// SPDX-License-Identifier: GPL-3.0-or-later
// Lee, Varshney and Jacobs 2005, with the signed curvature of Taubin 1995 as they computed it. Not in their
// paper, and chosen by us: the neighbourhood of a local maximum, which is the one-ring; the normalised range
// of maps, [0, 1]; and the simplification of surfaces larger than theirs.
// Mean NSS over the 19 meshes with ground truth at hand: .537 with the cotangent Laplacian, .586 as it is.
#include "stages/models/lvj.h"

#include <algorithm>
#include <cmath>

#include "stages/core/field.h"
#include "stages/core/parallel.h"
#include "stages/geometry/neighbours.h"
#include "stages/geometry/support.h"
#include "stages/models/coarse.h"

namespace salbench {
namespace {

constexpr double kReach = 2;          // reach of a Gaussian, in standard deviations
constexpr double kNoContrast = 1e-9;  // relative to the largest curvature, at least 1 / R: less is rounding
constexpr double kSameHeight = 1e-9;  // on normalised maps: differences of mirrored neighbours are smaller
constexpr std::size_t kGaussianGrain = 64;  // points per task, each with many neighbours

double diagonal_of_bounding_box(std::span<const Vec3> points) {
  Vec3 low = points.front(), high = low;
  for (const Vec3& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).norm();
}

// Standard deviations of all Gaussians, in epsilon, descending: each scale and its double. A Gaussian of half
// the width is the fourth power of the other, so that only three need an exponential.
constexpr std::array<int, 8> kWidths = {12, 10, 8, 6, 5, 4, 3, 2};
constexpr std::size_t kExponentials = 3;
constexpr std::array<std::size_t, 8> kTwiceAsWide = {0, 0, 0, 0, 1, 2, 3, 5};  // for those that need none

// Gaussian means of the values around one point.
class GaussianMeans {
 public:
  explicit GaussianMeans(double epsilon) {
    for (std::size_t k = 0; k < kWidths.size(); ++k) variance_[k] = std::pow(kWidths[k] * epsilon, 2);
  }

  void add(double distance_squared, double value) {
    std::array<double, kWidths.size()> weight;
    for (std::size_t k = 0; k < kWidths.size(); ++k) {
      if (distance_squared > kReach * kReach * variance_[k]) return;  // also out of reach of narrower ones
      if (k < kExponentials) {
        weight[k] = std::exp(-distance_squared / (2 * variance_[k]));
      } else {
        const double squared = weight[kTwiceAsWide[k]] * weight[kTwiceAsWide[k]];
        weight[k] = squared * squared;
      }
      weights_[k] += weight[k];
      sums_[k] += weight[k] * value;
    }
  }
  double of_width(int width) const {
    std::size_t k = 0;
    while (kWidths[k] != width) ++k;
    return sums_[k] / weights_[k];  // the point itself has weight 1
  }

 private:
  std::array<double, kWidths.size()> variance_{}, weights_{}, sums_{};
};

}  // namespace

std::array<ScalarField, kLvjScales.size()> centre_surround(std::span<const Vec3> points,
                                                           const ScalarField& values, double epsilon) {
  std::array<ScalarField, kLvjScales.size()> contrasts;
  for (ScalarField& contrast : contrasts) contrast.resize(points.size());
  const KdTree tree(points);
  const double reach = kReach * kWidths.front() * epsilon;
  require_few_neighbours(points, tree, reach);
  parallel_ranges(points.size(), kGaussianGrain, [&](std::size_t first, std::size_t last) {
    std::vector<Neighbour> around;
    for (std::size_t i = first; i < last; ++i) {
      tree.within_unordered(points[i], reach, around);
      GaussianMeans means(epsilon);
      for (const Neighbour& n : around) means.add(n.distance_squared, values[index(n.index)]);
      for (std::size_t s = 0; s < contrasts.size(); ++s)
        contrasts[s][i] = std::abs(means.of_width(kLvjScales[s]) - means.of_width(2 * kLvjScales[s]));
    }
  });
  return contrasts;
}

double suppression(std::span<const double> normalised, const Adjacency& adjacency) {
  const auto global = static_cast<std::size_t>(std::ranges::max_element(normalised) - normalised.begin());
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < normalised.size(); ++i) {
    const auto ring = adjacency.of(i);
    const auto above = [&](std::size_t a, std::size_t b) {
      return normalised[a] > normalised[b] + kSameHeight;
    };
    const bool is_peak = std::ranges::none_of(ring, [&](std::int32_t j) { return above(index(j), i); }) &&
                         std::ranges::any_of(ring, [&](std::int32_t j) { return above(i, index(j)); });
    if (!is_peak || i == global) continue;
    sum += normalised[i];
    ++count;
  }
  const double others = count > 0 ? sum / count : 0;
  return (1 - others) * (1 - others);
}

ScalarField lvj_saliency(Points points, Surface surface, const LvjOptions& options) {
  check(options);
  check_faces(points.size(), surface);
  const CoarseSurface coarse(in_units_of_radius(points), surface, static_cast<std::size_t>(options.faces));
  const Mesh& mesh = coarse.mesh();
  const ScalarField curvature = mean_curvature(mesh.vertices, mesh.faces, options.curvature);
  double largest = 1;
  for (const double value : curvature) largest = std::max(largest, std::abs(value));

  const Adjacency adjacency = edge_adjacency(mesh.vertices.size(), mesh.faces);
  ScalarField saliency(mesh.vertices.size(), 0);
  const double epsilon = options.epsilon * diagonal_of_bounding_box(mesh.vertices);
  for (const ScalarField& contrast : centre_surround(mesh.vertices, curvature, epsilon)) {
    const auto [low, high] = std::ranges::minmax_element(contrast);
    if (!(*high - *low > kNoContrast * largest)) continue;
    const ScalarField normalised = min_max_normalised(contrast);
    const double weight = suppression(normalised, adjacency);
    for (std::size_t i = 0; i < saliency.size(); ++i) saliency[i] += weight * normalised[i];
  }
  return coarse.on_all_points(std::move(saliency));
}

}  // namespace salbench
