// The simplified histograms (SPFH) of the requested points and their neighbours are computed once each, and
// then combined. Differences from the original publication are those of PCL and of the benchmark's authors:
// absolute values of the three features, and the weights that FpfhWeighting names.
#include "stages/core/fpfh.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/mesh_ops.h"

namespace salbench {
namespace {

constexpr std::size_t kBlockBins = 11;  // of each feature
constexpr std::size_t kBins = kFpfhBins;
constexpr double kBlockTotal = 100;  // of each block in the published weighting
constexpr double kMaxWeight = 1e12;  // limit of R / distance: below, the distance is rounding

const Vec3& at(std::span<const Vec3> points, std::int32_t i) { return points[static_cast<std::size_t>(i)]; }

// Bin of |value| among 11 over [-limit, limit]: the lower half, and half of the middle bin, stay empty.
std::size_t bin_of_magnitude(double value, double limit) {
  const double position = (std::abs(value) / limit + 1) / 2 * static_cast<double>(kBlockBins);
  return std::min(static_cast<std::size_t>(position), kBlockBins - 1);
}

// The SPFHs of some points. Row of point i: rows[row_of[i] * 33 ...].
struct SimplifiedHistograms {
  std::vector<float> rows;
  std::vector<std::size_t> row_of;  // by point; valid only for the requested points

  const float* of(std::int32_t point) const {
    return rows.data() + row_of[static_cast<std::size_t>(point)] * kBins;
  }
};

// neighbours.of(i) belongs to the point requested[i].
SimplifiedHistograms simplified_histograms(std::span<const Vec3> points, std::span<const Vec3> normals,
                                           std::span<const std::int32_t> requested,
                                           const Neighbourhoods& neighbours, bool swap) {
  SimplifiedHistograms result{std::vector<float>(requested.size() * kBins),
                              std::vector<std::size_t>(points.size())};
  for (std::size_t i = 0; i < requested.size(); ++i) {
    result.row_of[static_cast<std::size_t>(requested[i])] = i;
    const Vec3& p = at(points, requested[i]);
    const Vec3& n_p = at(normals, requested[i]);
    const auto found = neighbours.of(i);
    const auto distances_squared = neighbours.distances_squared_of(i);
    std::array<double, kBins> votes{};
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (distances_squared[k] == 0) continue;
      const DarbouxTriple pair = pair_features(p, n_p, at(points, found[k]), at(normals, found[k]), swap);
      votes[bin_of_magnitude(pair.theta, std::numbers::pi)] += 1;
      votes[kBlockBins + bin_of_magnitude(pair.alpha, 1)] += 1;
      votes[2 * kBlockBins + bin_of_magnitude(pair.phi, 1)] += 1;
    }
    const double others = std::max(static_cast<double>(found.size()) - 1, 1.0);
    for (std::size_t b = 0; b < kBins; ++b)
      result.rows[i * kBins + b] = static_cast<float>(votes[b] / others);
  }
  return result;
}

// Weights are relative to that of the nearest neighbour, which cancels in the scaling, so that they never
// overflow.
void combine_published(std::span<const std::int32_t> found, std::span<const double> distances_squared,
                       const SimplifiedHistograms& spfh, std::array<double, kBins>& sum) {
  const auto apart = std::upper_bound(distances_squared.begin(), distances_squared.end(), 0.0);
  for (auto d = apart; d != distances_squared.end(); ++d) {
    const double weight = *apart / *d;
    const float* row = spfh.of(found[static_cast<std::size_t>(d - distances_squared.begin())]);
    for (std::size_t b = 0; b < kBins; ++b) sum[b] += weight * static_cast<double>(row[b]);
  }
  for (std::size_t block = 0; block < kBins; block += kBlockBins) {
    const auto first = sum.begin() + static_cast<std::ptrdiff_t>(block);
    const double total = std::accumulate(first, first + kBlockBins, 0.0);
    if (total == 0) continue;
    std::for_each_n(first, kBlockBins, [&](double& value) { value *= kBlockTotal / total; });
  }
}

void combine_text(std::int32_t point, double unit, std::span<const std::int32_t> found,
                  std::span<const double> distances_squared, const SimplifiedHistograms& spfh,
                  std::array<double, kBins>& sum) {
  const double others = std::max(static_cast<double>(found.size()) - 1, 1.0);
  const float* own = spfh.of(point);
  for (std::size_t b = 0; b < kBins; ++b) sum[b] = static_cast<double>(own[b]);
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (distances_squared[k] == 0) continue;
    const double weight = std::min(unit / std::sqrt(distances_squared[k]), kMaxWeight) / others;
    const float* row = spfh.of(found[k]);
    for (std::size_t b = 0; b < kBins; ++b) sum[b] += weight * static_cast<double>(row[b]);
  }
}

std::vector<Vec3> points_at(std::span<const Vec3> points, std::span<const std::int32_t> indices) {
  std::vector<Vec3> result;
  result.reserve(indices.size());
  for (const std::int32_t i : indices) result.push_back(at(points, i));
  return result;
}

// The subset and all its neighbours, ascending.
std::vector<std::int32_t> with_neighbours(std::size_t n, std::span<const std::int32_t> subset,
                                          const Neighbourhoods& neighbours) {
  std::vector<bool> taken(n, false);
  for (const std::int32_t i : subset) taken[static_cast<std::size_t>(i)] = true;
  for (const std::int32_t i : neighbours.indices) taken[static_cast<std::size_t>(i)] = true;
  std::vector<std::int32_t> result;
  for (std::size_t i = 0; i < n; ++i)
    if (taken[i]) result.push_back(static_cast<std::int32_t>(i));
  return result;
}

void check_normals(std::span<const Vec3> points, std::span<const Vec3> normals) {
  CHECK_EQ(points.size(), normals.size());
  const auto bad =
      std::find_if_not(normals.begin(), normals.end(), [](const Vec3& n) { return n.allFinite(); });
  if (bad != normals.end())
    throw InputError("the normal of point " + std::to_string(bad - normals.begin()) +
                     " (0-based) is not finite");
}

}  // namespace

DarbouxTriple pair_features(const Vec3& p, const Vec3& n_p, const Vec3& q, const Vec3& n_q, bool swap) {
  Vec3 line = q - p;
  const double distance = line.norm();
  if (distance == 0) return {};
  line /= distance;
  const Vec3* u = &n_p;
  const Vec3* other = &n_q;
  if (swap && std::abs(n_p.dot(line)) < std::abs(n_q.dot(line))) {
    std::swap(u, other);
    line = -line;
  }
  // PCL has v = line x u where the paper has u x line: only the signs of alpha and theta depend on it.
  Vec3 v = line.cross(*u);
  const double sine = v.norm();
  if (sine == 0) return {};
  v /= sine;
  return {v.dot(*other), u->dot(line), std::atan2(u->cross(v).dot(*other), u->dot(*other))};
}

Neighbourhoods neighbourhoods(const KdTree& tree, std::span<const Vec3> queries, const Support& support) {
  CHECK_LE(0, support.neighbours);
  Neighbourhoods result;
  result.offsets.reserve(queries.size() + 1);
  result.offsets.push_back(0);
  const auto k = static_cast<std::size_t>(support.neighbours);
  result.indices.reserve(queries.size() * k);
  result.distances_squared.reserve(queries.size() * k);
  std::vector<Neighbour> found;
  for (const Vec3& query : queries) {
    if (k > 0)
      tree.nearest(query, k, found);
    else
      tree.within(query, support.radius, found);
    for (const Neighbour& neighbour : found) {
      result.indices.push_back(neighbour.index);
      result.distances_squared.push_back(neighbour.distance_squared);
    }
    result.offsets.push_back(result.indices.size());
  }
  return result;
}

Descriptors fpfh(std::span<const Vec3> points, std::span<const Vec3> normals, const KdTree& tree,
                 const Support& support, FpfhWeighting weighting, std::span<const std::int32_t> subset) {
  CHECK_EQ(points.size(), tree.size());
  check_normals(points, normals);
  const Neighbourhoods of_subset = neighbourhoods(tree, points_at(points, subset), support);
  const std::vector<std::int32_t> needed = with_neighbours(points.size(), subset, of_subset);
  const bool swap = weighting == FpfhWeighting::published;
  const SimplifiedHistograms spfh =
      std::equal(needed.begin(), needed.end(), subset.begin(), subset.end())
          ? simplified_histograms(points, normals, needed, of_subset, swap)
          : simplified_histograms(points, normals, needed,
                                  neighbourhoods(tree, points_at(points, needed), support), swap);

  const double unit = weighting == FpfhWeighting::text ? bounding_radius(points) : 1;
  Descriptors result{std::vector<float>(subset.size() * kBins), support.radius, support.neighbours};
  for (std::size_t i = 0; i < subset.size(); ++i) {
    std::array<double, kBins> sum{};
    if (weighting == FpfhWeighting::published)
      combine_published(of_subset.of(i), of_subset.distances_squared_of(i), spfh, sum);
    else
      combine_text(subset[i], unit, of_subset.of(i), of_subset.distances_squared_of(i), spfh, sum);
    std::transform(sum.begin(), sum.end(), result.values.begin() + static_cast<std::ptrdiff_t>(i * kBins),
                   [](double value) { return static_cast<float>(value); });
  }
  return result;
}

Descriptors fpfh(std::span<const Vec3> points, std::span<const Vec3> normals, const KdTree& tree,
                 const Support& support, FpfhWeighting weighting) {
  std::vector<std::int32_t> all(points.size());
  std::iota(all.begin(), all.end(), 0);
  return fpfh(points, normals, tree, support, weighting, all);
}

}  // namespace salbench
