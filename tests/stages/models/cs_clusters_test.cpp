// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/cs_clusters.h"

#include "stages/models/chi_square.h"
#include "stages/models/cs_cells.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

// One point in the middle of each unit cell of a square, moved by at most `jitter`: with radius 1 each is its
// own voxel, in the same order.
std::vector<Vec3> lattice(int side, double jitter = 0) {
  Rng rng(7, "lattice", "");
  std::vector<Vec3> points;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const double dx = jitter * (2 * rng.uniform() - 1), dy = jitter * (2 * rng.uniform() - 1);
      points.emplace_back(x + 0.5 + dx, y + 0.5 + dy, 0.5);
    }
  }
  return points;
}

// Rows of 100 in one bin of 33: maximally different descriptors if the bins differ.
template <class BinOf>
Descriptors descriptors_of(const std::vector<Vec3>& points, BinOf bin_of) {
  Descriptors descriptors;
  descriptors.values.resize(points.size() * kFpfhBins);
  for (std::size_t i = 0; i < points.size(); ++i)
    descriptors.values[i * kFpfhBins + index(bin_of(points[i]))] = 100;
  return descriptors;
}

Descriptors random_descriptors(std::size_t n) {
  Rng rng(11, "descriptors", "");
  Descriptors descriptors;
  for (std::size_t i = 0; i < n * kFpfhBins; ++i)
    descriptors.values.push_back(static_cast<float>(rng.uniform()));
  return descriptors;
}

int no_bin(const Vec3&) { return 0; }

// Seeds alone.
CsOptions seeds_for(std::int32_t clusters) { return {.clusters = clusters, .rounds = 0, .repair = false}; }

TEST(OccupiedCells, AreNumberedByZThenYThenX) {
  const std::vector<Vec3> points = {{0.5, 0.5, 1.5}, {0.5, 1.5, 0.5},  {1.5, 0.5, 0.5},
                                    {0.5, 0.5, 0.5}, {-0.5, 0.5, 0.5}, {0.9, 0.1, 0.3}};
  const OccupiedCells cells(points, 1);
  EXPECT_EQ(cells.size(), 5U);
  EXPECT_THAT(cells.find(points), ElementsAre(4, 3, 2, 1, 0, 1));
}

TEST(OccupiedCells, AlignWithTheOriginAndOwnTheirLowerBorder) {
  const std::vector<Vec3> points = {{0.75, 0, 0}, {1, 0, 0}};
  const OccupiedCells cells(points, 0.5);
  EXPECT_EQ(cells.find(Vec3(0.5, 0.25, 0)), 0);
  EXPECT_EQ(cells.find(Vec3(std::nextafter(1.0, 0.0), 0, 0)), 0);
  EXPECT_EQ(cells.find(Vec3(1.25, 0, 0)), 1);
  EXPECT_EQ(cells.find(Vec3(1.5, 0, 0)), OccupiedCells::kEmpty);
  EXPECT_EQ(cells.find(Vec3(0.75, -0.1, 0)), OccupiedCells::kEmpty);
}

TEST(GroupMeans, AreMeansAndZeroWithoutPoints) {
  const std::vector<Vec3> points = {{1, 2, 3}, {5, 0, 0}, {3, 4, 9}};
  const Descriptors descriptors = descriptors_of(points, [](const Vec3& p) { return p.x() > 2 ? 1 : 0; });
  const GroupMeans means = group_means(points, descriptors, std::vector<std::int32_t>{2, 0, 2}, 3);
  EXPECT_THAT(means.sizes, ElementsAre(1, 0, 2));
  EXPECT_THAT(means.centres, ElementsAre(Vec3(5, 0, 0), Vec3(0, 0, 0), Vec3(2, 3, 6)));
  EXPECT_EQ(means.descriptors.row(0)[1], 100);
  EXPECT_EQ(means.descriptors.row(1)[0], 0);
  EXPECT_EQ(means.descriptors.row(2)[0], 50);
  EXPECT_EQ(means.descriptors.row(2)[1], 50);
}

TEST(CsClusters, StartFromAGridThatHoldsEachClustersShare) {
  // 1600 voxels for 100 clusters: the 16th nearest, counting the voxel itself, is at the distance sqrt 5.
  const std::vector<Vec3> points = lattice(40);
  const Clusters clusters = cs_clusters(points, descriptors_of(points, no_bin), 1, 20, seeds_for(100));
  const OccupiedCells seeds(points, 2 * std::sqrt(5.0));
  EXPECT_EQ(clusters.count, seeds.size());
  EXPECT_EQ(clusters.of_point, seeds.find(points));
}

// Cells with a side of 1.345, aligned with the origin: [0, 1.345) contains both.
TEST(CsClusters, TheSpacingOfTwoVoxelsIsTheirDistance) {
  const std::vector<Vec3> points = {{0.1, 0.1, 0.1}, {1.1, 1.0, 0.1}};
  const Clusters clusters = cs_clusters(points, descriptors_of(points, no_bin), 1, 1, seeds_for(1));
  EXPECT_EQ(clusters.count, 1U);
  EXPECT_THAT(clusters.of_point, ElementsAre(0, 0));
}

TEST(CsClusters, OfFewVoxelsStartFromAGridOfTheirSpacing) {
  // Mean squared distance to the 8 nearest others: 12 / 8 inside, 19 / 8 along the border, 30 / 8 in a
  // corner.
  const std::vector<Vec3> points = lattice(40);
  const Clusters clusters = cs_clusters(points, descriptors_of(points, no_bin), 1, 20, seeds_for(1500));
  const OccupiedCells seeds(points, std::sqrt((38 * 38 * 12 + 4 * 38 * 19 + 4 * 30) / 8.0 / 1600));
  EXPECT_EQ(clusters.of_point, seeds.find(points));
}

// k-means as described, with every cluster offered to every voxel; `label` starts as the seeds.
std::vector<std::int32_t> plain_kmeans(const std::vector<Vec3>& points, const Descriptors& descriptors,
                                       std::vector<std::int32_t> label, std::size_t count, double weight) {
  GroupMeans means = group_means(points, descriptors, label, count);
  const auto distance = [&](std::size_t j, std::size_t k) {
    return (points[j] - means.centres[k]).squaredNorm();
  };
  const auto chi2 = [&](std::size_t j, std::size_t k) {
    return chi_square(descriptors.row(j), means.descriptors.row(k));
  };
  double far = 0, unlike = 0;
  for (std::size_t j = 0; j < points.size(); ++j) {
    far = std::max(far, distance(j, index(label[j])));
    unlike = std::max(unlike, chi2(j, index(label[j])));
  }
  const double reach_squared = 4 * far;
  std::vector<double> least(points.size(), 1e300);
  for (int round = 0; round < 30; ++round) {
    const std::vector<std::int32_t> before = label;
    double next_far = 0, next_unlike = 0;
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t j = 0; j < points.size(); ++j) {
        if (means.sizes[k] == 0 || distance(j, k) > reach_squared) continue;
        if (label[j] == static_cast<std::int32_t>(k)) {
          next_far = std::max(next_far, distance(j, k));
          next_unlike = std::max(next_unlike, chi2(j, k));
        }
        const double cost = distance(j, k) / far + weight * chi2(j, k) / unlike;
        if (cost >= least[j]) continue;
        least[j] = cost;
        label[j] = static_cast<std::int32_t>(k);
      }
    }
    far = next_far;
    unlike = next_unlike;
    if (label == before) break;
    means = group_means(points, descriptors, label, count);
  }
  return label;
}

// The same partition, with labels numbered in the order of their first points.
std::vector<std::int32_t> by_first_use(const std::vector<std::int32_t>& labels) {
  std::map<std::int32_t, std::int32_t> number;
  std::vector<std::int32_t> result;
  for (const std::int32_t label : labels)
    result.push_back(number.try_emplace(label, static_cast<std::int32_t>(number.size())).first->second);
  return result;
}

TEST(CsClusters, EqualPlainKMeans) {
  const std::vector<Vec3> points = lattice(30, 0.4);
  const Descriptors descriptors = random_descriptors(points.size());
  CsOptions options{.clusters = 60, .repair = false};
  for (const double weight : {0.5, 2.0, 20.0}) {
    options.descriptor_weight = weight;
    options.rounds = 0;
    const Clusters seeds = cs_clusters(points, descriptors, 1, 1e-12, options);
    options.rounds = 30;
    const Clusters clusters = cs_clusters(points, descriptors, 1, 1e-12, options);  // stops if nothing moves
    const auto expected = plain_kmeans(points, descriptors, seeds.of_point, seeds.count, weight);
    EXPECT_NE(by_first_use(seeds.of_point), by_first_use(expected)) << weight;
    EXPECT_EQ(by_first_use(clusters.of_point), by_first_use(expected)) << weight;
  }
}

// Descriptors that differ between the two sides of x = 13.37.
Descriptors two_sided(const std::vector<Vec3>& points) {
  return descriptors_of(points, [](const Vec3& p) { return p.x() < 13.37 ? 0 : 1; });
}

TEST(CsClusters, ComeToRest) {
  const std::vector<Vec3> points = lattice(40, 0.4);
  const auto clusters_after = [&](std::int32_t rounds, double unit) {
    const CsOptions options{.clusters = 100, .rounds = rounds, .descriptor_weight = 10};
    return cs_clusters(points, two_sided(points), 1, unit, options).of_point;
  };
  EXPECT_NE(clusters_after(30, 1), clusters_after(1, 1));
  // All centres together move less than 1e-4 of this unit in the first round.
  EXPECT_EQ(clusters_after(30, 1e9), clusters_after(1, 1));
}

TEST(CsClusters, StayOnTheirSideOfAGap) {
  std::vector<Vec3> points = lattice(25, 0.4);
  for (std::size_t i = 0, half = points.size(); i < half; ++i) points.push_back(points[i] + Vec3(0, 0, 60));
  const Clusters clusters = cs_clusters(points, descriptors_of(points, no_bin), 1, 35, {.clusters = 80});
  std::map<std::int32_t, bool> side_of_cluster;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool above = points[i].z() > 30;
    EXPECT_EQ(side_of_cluster.try_emplace(clusters.of_point[i], above).first->second, above) << i;
  }
}

// Number of voxels of a lattice that share their cluster with at most two of the eight around them.
int strays(const std::vector<std::int32_t>& of_point, int side) {
  int count = 0;
  for (int y = 1; y < side - 1; ++y) {
    for (int x = 1; x < side - 1; ++x) {
      int sharing = 0;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          sharing += of_point[index((y + dy) * side + x + dx)] == of_point[index(y * side + x)];
      count += sharing < 3;
    }
  }
  return count;
}

TEST(CsClusters, RepairLeavesFewStrays) {
  const int side = 40;
  const std::vector<Vec3> points = lattice(side);
  Rng rng(5, "odd ones", "");
  const Descriptors speckled = descriptors_of(
      points, [&](const Vec3&) { return rng.uniform() < 0.1 ? 1 + static_cast<int>(rng.below(4)) : 0; });
  CsOptions options{.clusters = 100, .descriptor_weight = 20};
  const int repaired = strays(cs_clusters(points, speckled, 1, 20, options).of_point, side);
  options.repair = false;
  const int unrepaired = strays(cs_clusters(points, speckled, 1, 20, options).of_point, side);
  EXPECT_GT(unrepaired, 100);
  EXPECT_LT(repaired, 10);
}

TEST(CsClusters, AreAboutAsManyAsAskedForAndNoneIsEmpty) {
  const std::vector<Vec3> points = shapes::bumpy_sphere(5).vertices;
  const Descriptors descriptors = random_descriptors(points.size());
  for (const std::int32_t aim : {50, 100, 500}) {
    const Clusters clusters = cs_clusters(points, descriptors, 0.03, 1, {.clusters = aim});
    EXPECT_GE(2 * clusters.count, index(aim));
    EXPECT_LE(2 * clusters.count, 3 * index(aim));
    const std::set<std::int32_t> used(clusters.of_point.begin(), clusters.of_point.end());
    EXPECT_EQ(used.size(), clusters.count);
    EXPECT_EQ(*used.begin(), 0);
    EXPECT_EQ(*used.rbegin(), static_cast<std::int32_t>(clusters.count) - 1);
  }
}

TEST(CsClusters, KeepTheVoxelsWhole) {
  const std::vector<Vec3> points = shapes::bumpy_sphere(5).vertices;
  const double radius = 0.05;
  const Clusters clusters =
      cs_clusters(points, random_descriptors(points.size()), radius, 1, {.clusters = 300});
  const std::vector<std::int32_t> voxel_of = OccupiedCells(points, radius).find(points);
  std::map<std::int32_t, std::int32_t> cluster_of_voxel;
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_EQ(cluster_of_voxel.try_emplace(voxel_of[i], clusters.of_point[i]).first->second,
              clusters.of_point[i]);
}

TEST(CsClusters, OfFewPointsOrVoxels) {
  const std::vector<Vec3> five = shapes::random_cloud(5, 1), twenty = shapes::random_cloud(20, 1);
  const Clusters of_points = cs_clusters(five, random_descriptors(5), 0.1, 1, {.clusters = 5});
  EXPECT_EQ(of_points.count, 5U);
  EXPECT_THAT(of_points.of_point, ElementsAre(0, 1, 2, 3, 4)) << "no more points than clusters";
  // Two voxels of two points each. Their centres, 0.02 apart, give a grid so fine that no point is near them.
  const std::vector<Vec3> pairs = {{0.99, 0.1, 0}, {0.99, 0.9, 0}, {1.01, 0.1, 0}, {1.01, 0.9, 0}};
  for (const Clusters& one :
       {cs_clusters(twenty, random_descriptors(20), 2, 1, {.clusters = 3}),  // one voxel
        cs_clusters(pairs, descriptors_of(pairs, no_bin), 1, 0.4, {.clusters = 2})}) {
    EXPECT_EQ(one.count, 1U);
    EXPECT_THAT(one.of_point, Each(0));
  }
}

}  // namespace
}  // namespace salbench
