// SPDX-License-Identifier: GPL-3.0-or-later
// Supervoxels: the points are gathered in the cells of a fine grid (voxels), and the voxels are clustered by
// k-means over position and descriptor. k-means starts from the cells of a coarse grid (seeds) and compares a
// voxel only with the clusters nearby, as SLIC does.
//
// Departures from the textbook follow the authors' program, on which the published maps depend:
// - A voxel changes its cluster only for a cost below the least it ever had, not below its present cost. As
//   the scale of the costs changes from round to round, most meshes then come to rest after a few rounds.
// - Clusters are visited in order, and the largest distances, which scale the costs of the next round, are
//   those to the voxels that a cluster still has when its turn comes.
// - At the end, a voxel with few neighbours in its own cluster joins the nearest other cluster.
// The top of cs.cpp lists the effect of each departure.
#include "stages/models/cs_clusters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "stages/core/check.h"
#include "stages/core/field.h"
#include "stages/geometry/neighbours.h"
#include "stages/models/chi_square.h"
#include "stages/models/cs_cells.h"

namespace salbench {
namespace {

constexpr std::size_t kBins = kFpfhBins;
constexpr std::size_t kSampledVoxels = 100;  // sample that determines the size of the seeds
constexpr std::size_t kSurroundings = 9;     // nearest voxels, including the voxel itself
constexpr double kRest = 1e-4;  // k-means ends if the centres' total motion is less, in units of R

using Labels = std::vector<std::int32_t>;  // by voxel: its seed or cluster

std::int32_t label_of(const Labels& labels, std::int32_t voxel) {
  return labels[static_cast<std::size_t>(voxel)];
}

// Centres and mean descriptors of the voxels, with a search tree over the centres.
struct Voxels {
  GroupMeans means;
  KdTree tree;

  explicit Voxels(GroupMeans of_voxels) : means(std::move(of_voxels)), tree(means.centres) {}
  std::size_t size() const { return means.size(); }
  const Vec3& centre(std::size_t j) const { return means.centres[j]; }
};

GroupMeans cluster_means(const Voxels& voxels, const Labels& labels, std::size_t count) {
  return group_means(voxels.means.centres, voxels.means.descriptors, labels, count);
}

// Side of the seeds' cells: twice the radius of a ball that holds a cluster's share of voxels, the median
// over a sample. If a cluster would have fewer than two voxels, the spacing of the voxels instead, as the
// root mean square distance to the nearest.
double seed_leaf(const Voxels& voxels, std::size_t clusters) {
  std::vector<Neighbour> found;
  if (voxels.size() > 2 * clusters) {
    const std::size_t share = voxels.size() / clusters;  // includes the voxel itself
    std::vector<double> reaches;
    for (std::size_t j = 0; j < voxels.size();
         j += std::max<std::size_t>(voxels.size() / kSampledVoxels, 1)) {
      voxels.tree.nearest(voxels.centre(j), share, found);
      reaches.push_back(found.back().distance_squared);
    }
    return 2 * std::sqrt(upper_median(std::move(reaches)));
  }
  double sum = 0;
  for (const Vec3& centre : voxels.means.centres) {
    voxels.tree.nearest(centre, kSurroundings, found);
    const double others = std::max(static_cast<double>(found.size()) - 1, 1.0);
    for (const Neighbour& neighbour : found) sum += neighbour.distance_squared / others;
  }
  return std::sqrt(sum / static_cast<double>(voxels.size()));
}

// The seed of a voxel is the one whose cell contains the voxel's centre. That cell may be unoccupied if its
// border cuts the voxel. The voxel then takes the seed of the nearest voxel within the radius that has one
// or, if there is none, the seed of its own first point.
Labels seed_labels(std::span<const Vec3> points, const Labels& voxel_of, const Voxels& voxels, double radius,
                   const OccupiedCells& seeds) {
  Labels labels = seeds.find(voxels.means.centres);
  std::vector<Neighbour> found;
  for (std::size_t j = 0; j < labels.size(); ++j) {
    if (labels[j] != OccupiedCells::kEmpty) continue;
    voxels.tree.within(voxels.centre(j), radius, found);
    const auto near = std::ranges::find_if(found, [&](const Neighbour& neighbour) {
      return label_of(labels, neighbour.index) != OccupiedCells::kEmpty;
    });
    if (near != found.end()) {
      labels[j] = label_of(labels, near->index);
    } else {
      const auto first = std::ranges::find(voxel_of, static_cast<std::int32_t>(j));
      labels[j] = seeds.find(points[static_cast<std::size_t>(first - voxel_of.begin())]);
    }
  }
  return labels;
}

// Largest distances between voxels and their clusters, which scale the costs.
struct Largest {
  double distance_squared = 0;
  double chi2 = 0;

  void include(double d2, double chi) {
    distance_squared = std::max(distance_squared, d2);
    chi2 = std::max(chi2, chi);
  }
};

Largest largest_distances(const Voxels& voxels, const Labels& labels, const GroupMeans& clusters) {
  Largest largest;
  for (std::size_t j = 0; j < labels.size(); ++j) {
    const auto k = static_cast<std::size_t>(labels[j]);
    largest.include((voxels.centre(j) - clusters.centres[k]).squaredNorm(),
                    chi_square(voxels.means.descriptors.row(j), clusters.descriptors.row(k)));
  }
  return largest;
}

// If every voxel coincides with its cluster, `largest` is 0 and the distance to any other cluster infinite.
double fraction_of(double distance, double largest) { return distance == 0 ? 0 : distance / largest; }

class KMeans {
 public:
  KMeans(const Voxels& voxels, Labels labels, std::size_t count, double unit, const CsOptions& options)
      : voxels_(voxels),
        chi_squares_(used_bins(voxels.means.descriptors)),
        labels_(std::move(labels)),
        clusters_(cluster_means(voxels, labels_, count)),
        largest_(largest_distances(voxels, labels_, clusters_)),
        reach_(2 * std::sqrt(largest_.distance_squared)),
        rest_(kRest * unit),
        descriptor_weight_(options.descriptor_weight),
        least_cost_(voxels.size(), std::numeric_limits<double>::max()) {}

  Labels run(std::int32_t rounds) && {
    for (std::int32_t round = 0; round < rounds; ++round) {
      largest_ = assign();
      if (update_means() < rest_) break;
    }
    return std::move(labels_);
  }

 private:
  // Offers each cluster to the voxels within reach of its centre.
  Largest assign() {
    Largest next;
    for (std::size_t k = 0; k < clusters_.size(); ++k) {
      if (clusters_.sizes[k] == 0) continue;
      voxels_.tree.within_unordered(clusters_.centres[k], reach_, found_);
      measure(clusters_.descriptors.row(k));
      for (std::size_t i = 0; i < found_.size(); ++i) {
        const Neighbour& voxel = found_[i];
        const auto j = static_cast<std::size_t>(voxel.index);
        const double chi2 = chi2_[i];
        if (labels_[j] == static_cast<std::int32_t>(k)) next.include(voxel.distance_squared, chi2);
        const double cost = fraction_of(voxel.distance_squared, largest_.distance_squared) +
                            descriptor_weight_ * fraction_of(chi2, largest_.chi2);
        if (cost < least_cost_[j]) {
          least_cost_[j] = cost;
          labels_[j] = static_cast<std::int32_t>(k);
        }
      }
    }
    return next;
  }

  // Distances of the found voxels from a cluster's descriptor.
  void measure(std::span<const float, kBins> cluster) {
    rows_.clear();
    for (const Neighbour& voxel : found_) rows_.push_back(voxel.index);
    chi2_.resize(rows_.size());
    chi_squares_.set_rows(voxels_.means.descriptors, rows_);
    chi_squares_.measure(cluster, chi2_);
  }

  // Returns the motion of the centres: the sum of the absolute differences along the axes.
  double update_means() {
    const std::vector<Vec3> before = std::move(clusters_.centres);
    clusters_ = cluster_means(voxels_, labels_, before.size());
    return std::transform_reduce(before.begin(), before.end(), clusters_.centres.begin(), 0.0, std::plus<>(),
                                 [](const Vec3& a, const Vec3& b) { return (a - b).lpNorm<1>(); });
  }

  const Voxels& voxels_;
  ChiSquares chi_squares_;
  Labels labels_;
  GroupMeans clusters_;
  Largest largest_;
  double reach_;  // from the first round, kept for all
  double rest_;
  double descriptor_weight_;
  std::vector<double> least_cost_;  // by voxel, over all rounds
  std::vector<Neighbour> found_;    // working memory, as the following
  std::vector<std::int32_t> rows_;
  std::vector<double> chi2_;
};

// A voxel joins the nearest other cluster if fewer than a third of its surroundings, including itself, are in
// its own. Voxels are visited in order, and each sees earlier changes.
void repair_connectivity(const Voxels& voxels, Labels& labels) {
  std::vector<Neighbour> found;
  for (std::size_t j = 0; j < labels.size(); ++j) {
    voxels.tree.nearest(voxels.centre(j), kSurroundings, found);
    const auto shares = [&](const Neighbour& near) { return label_of(labels, near.index) == labels[j]; };
    const auto sharing = static_cast<std::size_t>(std::count_if(found.begin(), found.end(), shares));
    if (sharing < found.size() / 3)
      labels[j] = label_of(labels, std::ranges::find_if_not(found, shares)->index);
  }
}

// Numbers the clusters in the order of their seeds, without those that have lost all their voxels.
Clusters numbered(const Labels& voxel_of, const Labels& labels, std::size_t seeds) {
  std::vector<std::int32_t> number(seeds, 0);
  for (const std::int32_t label : labels) number[static_cast<std::size_t>(label)] = 1;
  const auto count = static_cast<std::size_t>(std::count(number.begin(), number.end(), 1));
  std::exclusive_scan(number.begin(), number.end(), number.begin(), 0);
  Clusters clusters{{}, count};
  clusters.of_point.reserve(voxel_of.size());
  for (const std::int32_t voxel : voxel_of)
    clusters.of_point.push_back(number[static_cast<std::size_t>(label_of(labels, voxel))]);
  return clusters;
}

}  // namespace

GroupMeans group_means(std::span<const Vec3> points, const Descriptors& descriptors,
                       std::span<const std::int32_t> group_of, std::size_t count) {
  CHECK_EQ(points.size(), descriptors.size());
  CHECK_EQ(points.size(), group_of.size());
  GroupMeans means{std::vector<Vec3>(count, Vec3::Zero()), {}, std::vector<std::int32_t>(count)};
  means.descriptors.values.resize(count * kBins);
  std::vector<double> sums(count * kBins);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto group = static_cast<std::size_t>(group_of[i]);
    ++means.sizes[group];
    means.centres[group] += points[i];
    const auto row = descriptors.row(i);
    for (std::size_t bin = 0; bin < kBins; ++bin) sums[group * kBins + bin] += static_cast<double>(row[bin]);
  }
  for (std::size_t group = 0; group < count; ++group) {
    const double size = std::max(means.sizes[group], 1);
    means.centres[group] /= size;
    for (std::size_t entry = group * kBins; entry < (group + 1) * kBins; ++entry)
      means.descriptors.values[entry] = static_cast<float>(sums[entry] / size);
  }
  return means;
}

Clusters cs_clusters(std::span<const Vec3> points, const Descriptors& descriptors, double radius, double unit,
                     const CsOptions& options) {
  CHECK_GT(points.size(), 0U);
  const auto aim = static_cast<std::size_t>(options.clusters);
  if (points.size() <= aim) {
    Clusters clusters{std::vector<std::int32_t>(points.size()), points.size()};
    std::iota(clusters.of_point.begin(), clusters.of_point.end(), 0);
    return clusters;
  }
  const OccupiedCells cells(points, radius);
  const Labels voxel_of = cells.find(points);
  const Voxels voxels(group_means(points, descriptors, voxel_of, cells.size()));
  const double leaf = seed_leaf(voxels, aim);
  const OccupiedCells seeds(points, leaf > 0 ? leaf : radius);  // 0: a single voxel
  Labels labels =
      KMeans(voxels, seed_labels(points, voxel_of, voxels, radius, seeds), seeds.size(), unit, options)
          .run(options.rounds);
  if (options.repair) repair_connectivity(voxels, labels);
  return numbered(voxel_of, labels, seeds.size());
}

}  // namespace salbench
