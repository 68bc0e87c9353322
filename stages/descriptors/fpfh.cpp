// SPDX-License-Identifier: GPL-3.0-or-later
// The simplified histograms (SPFH) of the requested points and their neighbours are computed once each, and
// then combined. Differences from the original publication are those of PCL and of the benchmark's authors:
// absolute values of the three features, and the weights that FpfhWeighting names. Bins that absolute values
// never fill are left out until the end.
#include "stages/descriptors/fpfh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/parallel.h"
#include "stages/descriptors/pair_features.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {
namespace {

constexpr std::size_t kBlocks = 3;
constexpr std::size_t kBins = kBlocks * kFilledBins;
constexpr double kBlockTotal = 100;  // of each block in the published weighting
constexpr double kMaxWeight = 1e12;  // limit of R / distance: below, the distance is rounding

// A point without others has no votes to divide.
double divisor(std::size_t others) { return static_cast<double>(std::max<std::size_t>(others, 1)); }

// The neighbours of each point. What fits into memory is kept, and looked up where it is asked for again.
class Neighbourhoods {
 public:
  using Found = std::vector<Neighbour>;  // working memory of a search

  Neighbourhoods(std::span<const Vec3> points, const KdTree& tree, const Support& support)
      : points_(points), tree_(tree), support_(support) {
    CHECK_LE(0, support.neighbours);
    k_ = std::min(static_cast<std::size_t>(support.neighbours), tree.size());
    if (k_ == 0) {
      kept_at_.resize(points.size());
    } else if (points.size() * k_ <= kMostKept) {
      nearest_ = tree.nearest_of_each(points, k_);
    }
  }

  bool all_points() const { return tree_.size() == points_.size(); }
  // i is a neighbour of j where j is one of i.
  bool mutual() const { return k_ == 0 && all_points(); }

  // By (distance, index); valid until `found` is used again. The point itself is among them if the tree
  // contains it.
  std::span<const Neighbour> of(std::int32_t i, Found& found) const {
    if (k_ > 0) {
      const std::size_t k = k_of(i);
      if (nearest_) return nearest_->of(static_cast<std::size_t>(i)).first(k);
      tree_.nearest(at(points_, i), k, found);
    } else if (const auto kept = kept_of(i); !kept.empty()) {
      found.assign(kept.begin(), kept.end());
      std::ranges::sort(found, closer);
    } else {
      tree_.within(at(points_, i), support_.radius, found);
    }
    return found;
  }
  std::span<const Neighbour> unordered(std::int32_t i, Found& found) const {
    if (k_ > 0) return of(i, found);
    if (const auto kept = kept_of(i); !kept.empty()) return kept;
    tree_.within_unordered(at(points_, i), support_.radius, found);
    return found;
  }
  // The same, by one thread alone: what it finds is kept.
  std::span<const Neighbour> unordered_kept(std::int32_t i, Found& found) {
    const auto these = unordered(i, found);
    if (k_ == 0 && these.data() == found.data() && kept_.size() + these.size() <= kMostKept) {
      kept_at_[static_cast<std::size_t>(i)] = {kept_.size(), these.size()};
      kept_.insert(kept_.end(), these.begin(), these.end());
    }
    return these;
  }

  double radius() const { return support_.radius; }
  // How many of the neighbours of i are other points.
  std::size_t others(std::int32_t i, std::span<const Neighbour> found) const {
    return found.size() - (tree_.contains(i) ? 1 : 0);
  }

 private:
  static constexpr std::size_t kMostKept = 1 << 20;  // 16 MB

  struct Kept {
    std::size_t first = 0, count = 0;
  };
  // A point counts itself among its nearest, found or not.
  std::size_t k_of(std::int32_t i) const {
    return tree_.contains(i) ? k_ : std::min(k_, static_cast<std::size_t>(support_.neighbours) - 1);
  }
  std::span<const Neighbour> kept_of(std::int32_t i) const {
    const Kept& kept = kept_at_[static_cast<std::size_t>(i)];
    return std::span(kept_).subspan(kept.first, kept.count);
  }

  std::span<const Vec3> points_;
  const KdTree& tree_;
  Support support_;
  std::size_t k_ = 0;  // 0: a radius
  std::optional<NearestPoints> nearest_;
  std::vector<Neighbour> kept_;  // of a radius
  std::vector<Kept> kept_at_;    // by point
};

// The points that are not among these, which ascend.
std::vector<std::int32_t> others_than(const std::vector<std::int32_t>& these, std::size_t n) {
  std::vector<std::int32_t> others;
  others.reserve(n - these.size());
  auto next = these.begin();
  for (std::size_t i = 0; i < n; ++i)
    if (next != these.end() && *next == static_cast<std::int32_t>(i))
      ++next;
    else
      others.push_back(static_cast<std::int32_t>(i));
  return others;
}

// The SPFHs of some points.
class SimplifiedHistograms {
 public:
  SimplifiedHistograms(std::span<const Vec3> points, std::span<const Vec3> normals,
                       const std::vector<std::int32_t>& requested, const Neighbourhoods& neighbourhoods,
                       bool swap)
      : points_(points), normals_(normals), row_of_(points.size(), kNone), swap_(swap) {
    for (std::size_t row = 0; row < requested.size(); ++row)
      row_of_[static_cast<std::size_t>(requested[row])] = row;
    votes_.resize(requested.size());
    neighbours_.resize(requested.size());
    if (neighbourhoods.mutual() && requested.size() <= kOneThread)
      vote_by_pairs(requested, neighbourhoods.radius());
    else
      vote_by_points(requested, neighbourhoods);
    rows_.reserve(requested.size() * kBins);
    for (std::size_t row = 0; row < requested.size(); ++row)
      for (const std::uint32_t count : votes_[row])
        rows_.push_back(static_cast<float>(static_cast<double>(count) / divisor(neighbours_[row])));
    votes_ = {};
  }

  const float* of(std::int32_t point) const { return rows_.data() + row_of(point) * kBins; }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  static constexpr std::size_t kOneThread = 1 << 16;

  using Votes = std::array<std::uint32_t, kBins>;

  void vote_by_points(const std::vector<std::int32_t>& requested, const Neighbourhoods& neighbourhoods) {
    parallel_ranges(requested.size(), kPointGrain, [&](std::size_t first, std::size_t last) {
      Neighbourhoods::Found memory;
      for (std::size_t row = first; row < last; ++row) {
        const auto found = neighbourhoods.unordered(requested[row], memory);
        neighbours_[row] = neighbourhoods.others(requested[row], found);
        vote(requested[row], found, false);
      }
    });
  }

  // Each pair of requested points is looked at once, for both: by one thread, because it writes to both.
  void vote_by_pairs(const std::vector<std::int32_t>& requested, double radius) {
    KdTree(points_, requested).pairs_within(radius, [&](std::int32_t i, std::span<const Neighbour> found) {
      neighbours_[row_of(i)] += found.size();
      for (const Neighbour& neighbour : found) ++neighbours_[row_of(neighbour.index)];
      vote(i, found, true);
    });
    if (requested.size() == points_.size()) return;
    const KdTree others(points_, others_than(requested, points_.size()));
    Neighbourhoods::Found found;
    for (const std::int32_t i : requested) {
      others.within_unordered(at(points_, i), radius, found);
      neighbours_[row_of(i)] += found.size();
      vote(i, found, false);
    }
  }

  // For the point itself, or for both ends of each pair.
  void vote(std::int32_t i, std::span<const Neighbour> found, bool both) {
    Votes own{};
    std::array<std::int32_t, kPairs> others;
    std::size_t count = 0;
    const auto look = [&] {
      look_at_pairs(i, std::span(others).first(count), both, own);
      count = 0;
    };
    for (const Neighbour& neighbour : found) {
      if (neighbour.coincides()) continue;
      others[count++] = neighbour.index;
      if (count == kPairs) look();
    }
    if (count > 0) look();
    Votes& sum = votes_[row_of(i)];
    for (std::size_t b = 0; b < kBins; ++b) sum[b] += own[b];
  }

  void look_at_pairs(std::int32_t i, std::span<const std::int32_t> others, bool both, Votes& own) {
    std::array<PairBins, kPairs> bins;
    pair_bins(at(points_, i), at(normals_, i), points_, normals_, others, swap_, bins);
    for (std::size_t pair = 0; pair < others.size(); ++pair) {
      add(bins[pair], own);
      if (!both) continue;
      const std::int32_t j = others[pair];
      add(bins[pair].both_ways
              ? bins[pair]
              : pair_bins(at(points_, j), at(normals_, j), at(points_, i), at(normals_, i), swap_),
          votes_[row_of(j)]);
    }
  }

  std::size_t row_of(std::int32_t point) const { return row_of_[static_cast<std::size_t>(point)]; }

  static void add(const PairBins& bins, Votes& votes) {
    ++votes[bins.theta];
    ++votes[kFilledBins + bins.alpha];
    ++votes[2 * kFilledBins + bins.phi];
  }

  std::span<const Vec3> points_, normals_;
  std::vector<std::size_t> row_of_;
  std::vector<Votes> votes_;
  std::vector<std::size_t> neighbours_;  // other points that voted
  std::vector<float> rows_;              // shares of votes
  bool swap_;
};

using Filled = std::array<double, kBins>;

// Weights are relative to that of the nearest neighbour, which cancels in the scaling, so that they never
// overflow.
void combine_published(std::span<const Neighbour> found, const SimplifiedHistograms& spfh, Filled& sum) {
  const auto apart = std::ranges::find_if(found, [](const Neighbour& n) { return !n.coincides(); });
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

void combine_text(std::int32_t point, double unit, std::span<const Neighbour> found, std::size_t others,
                  const SimplifiedHistograms& spfh, Filled& sum) {
  const float* own = spfh.of(point);
  const double count = divisor(others);
  for (std::size_t b = 0; b < kBins; ++b) sum[b] = static_cast<double>(own[b]);
  for (const Neighbour& n : found) {
    if (n.coincides()) continue;
    const double weight = std::min(unit / std::sqrt(n.distance_squared), kMaxWeight) / count;
    const float* row = spfh.of(n.index);
    for (std::size_t b = 0; b < kBins; ++b) sum[b] += weight * static_cast<double>(row[b]);
  }
}

// Those whose SPFH counts, ascending: the neighbours of the subset and, unless only neighbours count, itself.
std::vector<std::int32_t> needed(std::size_t n, std::span<const std::int32_t> subset,
                                 Neighbourhoods& neighbourhoods, bool neighbours_only) {
  if (subset.size() == n && (neighbourhoods.all_points() || !neighbours_only))
    return {subset.begin(), subset.end()};
  std::vector<bool> taken(n, false);
  Neighbourhoods::Found memory;
  for (const std::int32_t i : subset) {
    if (!neighbours_only) taken[static_cast<std::size_t>(i)] = true;
    for (const Neighbour& neighbour : neighbourhoods.unordered_kept(i, memory))
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
  Neighbourhoods neighbourhoods(points, tree, support);
  const bool published = weighting == FpfhWeighting::published;
  const SimplifiedHistograms spfh(points, normals, needed(points.size(), subset, neighbourhoods, published),
                                  neighbourhoods, published);

  const double unit = published ? 1 : bounding_radius(points);
  Descriptors result{std::vector<float>(subset.size() * kFpfhBins), support.radius, support.neighbours};
  parallel_ranges(subset.size(), kPointGrain, [&](std::size_t first, std::size_t last) {
    Neighbourhoods::Found memory;
    for (std::size_t i = first; i < last; ++i) {
      Filled sum{};
      const auto found = neighbourhoods.of(subset[i], memory);
      if (published)
        combine_published(found, spfh, sum);
      else
        combine_text(subset[i], unit, found, neighbourhoods.others(subset[i], found), spfh, sum);
      for (std::size_t b = 0; b < kBins; ++b)
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
  if (!centroid(points).allFinite() || !std::isfinite(bounding_radius(points)))
    throw ShapeError("the shape has a coordinate that is not finite, or whose square overflows");
  const KdTree tree(points);
  return fpfh(points, normals, tree, support_of(points, tree, options), options.weighting);
}

}  // namespace salbench
