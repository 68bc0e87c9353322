// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/neighbours.h"

#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

// Brute-force reference: every distance, sorted by (distance, index).
std::vector<Neighbour> all_sorted(const std::vector<Vec3>& points, const Vec3& query) {
  std::vector<Neighbour> all;
  for (std::size_t i = 0; i < points.size(); ++i)
    all.push_back({static_cast<std::int32_t>(i), (points[i] - query).squaredNorm()});
  std::ranges::sort(all, [](const Neighbour& a, const Neighbour& b) {
    return std::pair(a.distance_squared, a.index) < std::pair(b.distance_squared, b.index);
  });
  return all;
}

std::vector<std::int32_t> indices(const std::vector<Neighbour>& found) {
  std::vector<std::int32_t> result;
  for (const Neighbour& n : found) result.push_back(n.index);
  return result;
}

TEST(KdTree, NearestEqualsBruteForceAlsoOnTies) {
  // A lattice has many equal distances; a random cloud has none.
  std::vector<std::vector<Vec3>> clouds = {shapes::random_cloud(500, 3), {}};
  for (int i = 0; i < 512; ++i) clouds[1].emplace_back(i / 64, i / 8 % 8, i % 8);
  for (const auto& cloud : clouds) {
    const KdTree tree(cloud);
    std::vector<Neighbour> found;
    for (const std::size_t k : {10U, 65U, 130U, 400U})
      for (std::size_t i = 0; i < cloud.size(); i += k == 10 ? 7 : 97) {
        auto expected = all_sorted(cloud, cloud[i]);
        tree.nearest(cloud[i], k, found);
        expected.resize(k);
        EXPECT_EQ(indices(found), indices(expected)) << k << " nearest of " << i;
      }
  }
}

TEST(KdTree, NeighbourhoodsAreTheNearestOfEachPoint) {
  const std::vector<Vec3> cloud = shapes::random_cloud(2500, 5);  // more than one range of points
  const KdTree tree(cloud);
  const NearestPoints all = tree.nearest_of_each(cloud, 7);
  std::vector<Neighbour> found;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    tree.nearest(cloud[i], 7, found);
    EXPECT_EQ(indices({all.of(i).begin(), all.of(i).end()}), indices(found)) << "point " << i;
  }
  const std::vector<Vec3> few(cloud.begin(), cloud.begin() + 3);
  EXPECT_EQ(KdTree(few).nearest_of_each(few, 7).each(), 3U);
  EXPECT_EQ(tree.nearest_of_each({}, 7).size(), 0U);
}

TEST(KdTree, OfSomePointsFindsOnlyThese) {
  const std::vector<Vec3> cloud = shapes::random_cloud(500, 5);
  std::vector<std::int32_t> members;
  for (std::int32_t i = 3; i < 500; i += 4) members.push_back(i);
  const KdTree tree(cloud, members);
  ASSERT_EQ(tree.size(), members.size());
  for (std::int32_t i = 0; i < 500; ++i) EXPECT_EQ(tree.contains(i), i % 4 == 3);
  EXPECT_TRUE(KdTree(cloud).contains(0));
  std::vector<Neighbour> found;
  for (std::size_t i = 0; i < cloud.size(); i += 31) {
    auto expected = all_sorted(cloud, cloud[i]);
    std::erase_if(expected, [](const Neighbour& n) { return n.index % 4 != 3; });
    tree.within(cloud[i], std::sqrt(expected[80].distance_squared) * (1 + 1e-12), found);
    expected.resize(81);
    EXPECT_EQ(indices(found), indices(expected));
    tree.nearest(cloud[i], 70, found);
    expected.resize(70);
    EXPECT_EQ(indices(found), indices(expected));
    EXPECT_EQ(tree.nearest(cloud[i]), expected[0].index);
  }
}

// Half of the points lie in a corner of an eighth of the volume; so does half of the sample.
TEST(KdTree, AnEvenSampleIsAsDenseAsTheShape) {
  std::vector<Vec3> cloud = shapes::random_cloud(4000, 6);
  for (std::size_t i = 0; i < 4000; i += 2) cloud[i] = Vec3::Constant(5) + 0.1 * cloud[i];
  const KdTree tree(cloud);
  const std::vector<std::int32_t> sample = tree.even_sample(400);
  ASSERT_EQ(sample.size(), 400U);
  EXPECT_TRUE(std::ranges::is_sorted(sample));
  EXPECT_EQ(std::ranges::adjacent_find(sample), sample.end());
  const auto in_corner =
      std::count_if(sample.begin(), sample.end(), [](std::int32_t point) { return point % 2 == 0; });
  EXPECT_LE(std::abs(in_corner - 200), 4);
  EXPECT_EQ(tree.even_sample(9999).size(), 4000U);
  EXPECT_TRUE(KdTree(std::vector<Vec3>()).even_sample(3).empty());
}

TEST(KdTree, WithinTakesTheBoundary) {
  const std::vector<Vec3> line = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  const KdTree tree(line);
  std::vector<Neighbour> found;
  tree.within(line[1], 1.0, found);
  EXPECT_EQ(indices(found), (std::vector<std::int32_t>{1, 0, 2}));
}

TEST(KdTree, PairsWithinARadiusComeOnceEach) {
  std::vector<std::vector<Vec3>> clouds = {shapes::random_cloud(700, 5), {}, {}, {}};
  for (int i = 0; i < 343; ++i)
    clouds[1].emplace_back(i / 49, i / 7 % 7, i % 7);  // many exactly 1 or 2 apart
  clouds[2].assign(40, Vec3(1, 2, 3));                 // more than a leaf holds
  for (const auto& cloud : clouds)
    for (const double radius : {0.0, 0.3, 1.0, 2.0, 100.0}) {
      std::vector<std::pair<std::int32_t, std::int32_t>> pairs, expected;
      for (std::int32_t i = 0; i < static_cast<std::int32_t>(cloud.size()); ++i)
        for (const Neighbour& n : all_sorted(cloud, cloud[index(i)]))
          if (n.index > i && n.distance_squared <= radius * radius) expected.emplace_back(i, n.index);
      std::vector<std::int32_t> visited;
      KdTree(cloud).pairs_within(radius, [&](std::int32_t i, std::span<const Neighbour> found) {
        visited.push_back(i);
        for (const Neighbour& n : found) {
          pairs.push_back(std::minmax(i, n.index));
          EXPECT_EQ(n.distance_squared, (cloud[index(i)] - cloud[index(n.index)]).squaredNorm());
        }
      });
      std::ranges::sort(pairs);
      std::ranges::sort(expected);
      EXPECT_EQ(pairs, expected) << cloud.size() << " points, radius " << radius;
      const std::size_t all = cloud.size() * cloud.size();
      EXPECT_EQ(KdTree(cloud).count_pairs_within(radius / 3, radius, expected.size()).value()[1],
                expected.size());
      EXPECT_EQ(KdTree(cloud).count_pairs_within(radius, 3 * radius, all).value()[0], expected.size());
      const std::size_t fewer = expected.size() - std::min<std::size_t>(expected.size(), 1);
      EXPECT_EQ(KdTree(cloud).count_pairs_within(radius / 3, radius, fewer).has_value(), expected.empty());
      std::ranges::sort(visited);
      for (std::size_t i = 0; i < visited.size(); ++i) EXPECT_EQ(visited[i], static_cast<std::int32_t>(i));
      EXPECT_EQ(visited.size(), cloud.size());
    }
}

TEST(KdTree, FindsNoMoreThanIsAskedForAndNoMoreThanThereIs) {
  const std::vector<Vec3> same(100, Vec3(1, 2, 3));
  const KdTree tree(same);
  std::vector<Neighbour> found = {{7, 1.0}};
  tree.nearest(same[50], 0, found);
  EXPECT_THAT(found, IsEmpty());
  tree.nearest(same[50], 4, found);
  EXPECT_THAT(indices(found), ElementsAre(0, 1, 2, 3)) << "in order of index";
  tree.nearest(same[50], 109, found);
  EXPECT_THAT(found, SizeIs(100));
}

// Otherwise the search would find nothing and return a nonexistent point.
TEST(KdTree, RefusesWhereDistancesCannotBeSquared) {
  const std::vector<Vec3> cloud = shapes::random_cloud(200, 7);
  const KdTree tree(cloud);
  std::vector<Neighbour> found;
  for (const double far : {1e155, 1e300, kInfinity, std::nan("")}) {
    const Vec3 query(0, far, 0);
    EXPECT_THROW(tree.nearest(query), InputError) << far;
    for (const std::size_t k : {1U, 5U, 150U})
      EXPECT_THROW(tree.nearest(query, k, found), InputError) << far << " " << k;
    EXPECT_THROW(tree.nearest_of_each(std::vector{query}, 3), InputError) << far;
  }
  EXPECT_NO_THROW(tree.nearest(Vec3(0, 1e150, 0)));
  for (const double nowhere : {kInfinity, std::nan("")})
    EXPECT_THROW(KdTree(std::vector<Vec3>{{0, 0, 0}, {nowhere, 0, 0}}), InputError);
}

}  // namespace
}  // namespace salbench
