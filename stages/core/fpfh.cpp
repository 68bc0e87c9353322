// The simplified histograms (SPFH) of the requested points and their neighbours are computed once each, and
// then combined. Differences from the original publication are those of PCL and of the benchmark's authors:
// absolute values of the three features, and the weights that FpfhWeighting names. Bins that absolute values
// never fill are left out until the end.
#include "stages/core/fpfh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/mesh_ops.h"
#include "stages/core/pair_features.h"

namespace salbench {
namespace {

constexpr std::size_t kBlocks = 3;
constexpr std::size_t kBins = kBlocks * kFilledBins;
constexpr double kBlockTotal = 100;  // of each block in the published weighting
constexpr double kMaxWeight = 1e12;  // limit of R / distance: below, the distance is rounding

const Vec3& at(std::span<const Vec3> points, std::int32_t i) { return points[static_cast<std::size_t>(i)]; }

// The neighbours of each point. Those within a radius may be many: they are searched anew each time. Nearest
// ones are few, and kept.
class Neighbourhoods {
 public:
  Neighbourhoods(std::span<const Vec3> points, const KdTree& tree, const Support& support)
      : points_(points), tree_(tree), support_(support) {
    CHECK_LE(0, support.neighbours);
    k_ = std::min(static_cast<std::size_t>(support.neighbours), points.size());
    nearest_.reserve(points.size() * k_);
    for (std::size_t i = 0; k_ > 0 && i < points.size(); ++i) {
      tree.nearest(points[i], k_, found_);
      nearest_.insert(nearest_.end(), found_.begin(), found_.end());
    }
  }

  // i is a neighbour of j where j is one of i.
  bool mutual() const { return k_ == 0; }

  // By (distance, index), the point itself included; valid until the next call.
  std::span<const Neighbour> of(std::int32_t i) {
    if (k_ > 0) return kept(i);
    tree_.within(at(points_, i), support_.radius, found_);
    return found_;
  }
  std::span<const Neighbour> unordered(std::int32_t i) {
    if (k_ > 0) return kept(i);
    tree_.within_unordered(at(points_, i), support_.radius, found_);
    return found_;
  }

 private:
  std::span<const Neighbour> kept(std::int32_t i) const {
    return std::span(nearest_).subspan(static_cast<std::size_t>(i) * k_, k_);
  }

  std::span<const Vec3> points_;
  const KdTree& tree_;
  Support support_;
  std::size_t k_ = 0;
  std::vector<Neighbour> nearest_, found_;
};

// The SPFHs of some points.
class SimplifiedHistograms {
 public:
  SimplifiedHistograms(std::span<const Vec3> points, std::span<const Vec3> normals,
                       const std::vector<bool>& requested, Neighbourhoods& neighbourhoods, bool swap)
      : points_(points), normals_(normals), row_of_(points.size(), kNone), swap_(swap) {
    std::size_t rows = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (requested[i]) row_of_[i] = rows++;
    rows_.resize(rows * kBins);
    std::vector<float> others(rows);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (requested[i]) {
        const auto found = neighbourhoods.unordered(static_cast<std::int32_t>(i));
        others[row_of_[i]] = static_cast<float>(std::max<std::size_t>(found.size(), 2) - 1);
        vote(static_cast<std::int32_t>(i), found, neighbourhoods.mutual());
      }
    for (std::size_t row = 0; row < rows; ++row)
      for (std::size_t b = 0; b < kBins; ++b)
        rows_[row * kBins + b] = quotient(rows_[row * kBins + b], others[row]);
  }

  const float* of(std::int32_t point) const {
    return rows_.data() + row_of_[static_cast<std::size_t>(point)] * kBins;
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  // Whole numbers, exact as floats: their order does not matter.
  static float quotient(float votes, float others) {
    return static_cast<float>(static_cast<double>(votes) / static_cast<double>(others));
  }

  // A pair of requested points that are mutual neighbours is looked at once, from the lower index.
  void vote(std::int32_t i, std::span<const Neighbour> found, bool mutual) {
    for (const Neighbour& neighbour : found) {
      if (neighbour.distance_squared == 0) continue;
      const std::int32_t j = neighbour.index;
      const bool for_both = mutual && row_of_[static_cast<std::size_t>(j)] != kNone;
      if (for_both && j < i) continue;
      const PairBins bins = bins_of(i, j);
      add(i, bins);
      if (for_both) add(j, bins.both_ways ? bins : bins_of(j, i));
    }
  }

  PairBins bins_of(std::int32_t i, std::int32_t j) const {
    return pair_bins(at(points_, i), at(normals_, i), at(points_, j), at(normals_, j), swap_);
  }

  void add(std::int32_t i, const PairBins& bins) {
    float* const row = rows_.data() + row_of_[static_cast<std::size_t>(i)] * kBins;
    row[bins.theta] += 1;
    row[kFilledBins + bins.alpha] += 1;
    row[2 * kFilledBins + bins.phi] += 1;
  }

  std::span<const Vec3> points_, normals_;
  std::vector<std::size_t> row_of_;
  std::vector<float> rows_;  // votes, then shares of votes
  bool swap_;
};

using Filled = std::array<double, kBins>;

// Weights are relative to that of the nearest neighbour, which cancels in the scaling, so that they never
// overflow.
void combine_published(std::span<const Neighbour> found, const SimplifiedHistograms& spfh, Filled& sum) {
  const auto apart =
      std::find_if(found.begin(), found.end(), [](const Neighbour& n) { return n.distance_squared > 0; });
  for (auto n = apart; n != found.end(); ++n) {
    const double weight = apart->distance_squared / n->distance_squared;
    const float* row = spfh.of(n->index);
    for (std::size_t b = 0; b < kBins; ++b) sum[b] += weight * static_cast<double>(row[b]);
  }
  for (std::size_t block = 0; block < kBins; block += kFilledBins) {
    const auto first = sum.begin() + static_cast<std::ptrdiff_t>(block);
    const double total = std::accumulate(first, first + kFilledBins, 0.0);
    if (total == 0) continue;
    std::for_each_n(first, kFilledBins, [&](double& value) { value *= kBlockTotal / total; });
  }
}

void combine_text(std::int32_t point, double unit, std::span<const Neighbour> found,
                  const SimplifiedHistograms& spfh, Filled& sum) {
  const double others = std::max(static_cast<double>(found.size()) - 1, 1.0);
  const float* own = spfh.of(point);
  for (std::size_t b = 0; b < kBins; ++b) sum[b] = static_cast<double>(own[b]);
  for (const Neighbour& n : found) {
    if (n.distance_squared == 0) continue;
    const double weight = std::min(unit / std::sqrt(n.distance_squared), kMaxWeight) / others;
    const float* row = spfh.of(n.index);
    for (std::size_t b = 0; b < kBins; ++b) sum[b] += weight * static_cast<double>(row[b]);
  }
}

// The subset and all its neighbours.
std::vector<bool> with_neighbours(std::size_t n, std::span<const std::int32_t> subset,
                                  Neighbourhoods& neighbourhoods) {
  if (subset.size() == n) return std::vector<bool>(n, true);
  std::vector<bool> taken(n, false);
  for (const std::int32_t i : subset) {
    taken[static_cast<std::size_t>(i)] = true;
    for (const Neighbour& neighbour : neighbourhoods.unordered(i))
      taken[static_cast<std::size_t>(neighbour.index)] = true;
  }
  return taken;
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

Descriptors fpfh(std::span<const Vec3> points, std::span<const Vec3> normals, const KdTree& tree,
                 const Support& support, FpfhWeighting weighting, std::span<const std::int32_t> subset) {
  CHECK_EQ(points.size(), tree.size());
  check_normals(points, normals);
  Neighbourhoods neighbourhoods(points, tree, support);
  const bool published = weighting == FpfhWeighting::published;
  const SimplifiedHistograms spfh(points, normals, with_neighbours(points.size(), subset, neighbourhoods),
                                  neighbourhoods, published);

  const double unit = published ? 1 : bounding_radius(points);
  Descriptors result{std::vector<float>(subset.size() * kFpfhBins), support.radius, support.neighbours};
  for (std::size_t i = 0; i < subset.size(); ++i) {
    Filled sum{};
    if (published)
      combine_published(neighbourhoods.of(subset[i]), spfh, sum);
    else
      combine_text(subset[i], unit, neighbourhoods.of(subset[i]), spfh, sum);
    for (std::size_t b = 0; b < kBins; ++b)
      result.values[i * kFpfhBins + b / kFilledBins * kBlockBins + kFirstFilled + b % kFilledBins] =
          static_cast<float>(sum[b]);
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
