// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/support.h"

#include "stages/geometry/mesh_ops.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

double brute_force_mean(const std::vector<Vec3>& points, double radius) {
  double pairs = 0;
  for (const Vec3& p : points)
    for (const Vec3& q : points) pairs += (p - q).squaredNorm() <= radius * radius ? 1 : 0;
  const auto n = static_cast<double>(points.size());
  return (pairs - n) / n;
}

TEST(MeanNeighbourCounts, EqualBruteForce) {
  const auto cloud = shapes::random_cloud(300, 11);
  const double small = 0.04;
  for (const double radius : {0.04, 0.05, 0.2, 2.0}) {
    const double exact = brute_force_mean(cloud, radius);
    const auto [within_small, within] = mean_neighbour_counts(KdTree(cloud), small, radius, exact).value();
    EXPECT_DOUBLE_EQ(within_small, brute_force_mean(cloud, small));
    EXPECT_DOUBLE_EQ(within, exact);
    EXPECT_FALSE(mean_neighbour_counts(KdTree(cloud), small, radius, exact - 0.01));
  }
  EXPECT_EQ(mean_neighbour_counts(KdTree(cloud), 0, 0, 0).value()[1], 0);
}

TEST(MedianSpacing, IsTheDistanceToTheNearestOther) {
  std::vector<Vec3> row;  // gaps 1, 2, 4, 8, 16
  for (const double x : {0, 1, 3, 7, 15, 31}) row.emplace_back(x, 0, 0);
  const auto spacing = [](const std::vector<Vec3>& points, std::size_t k) {
    return median_spacing(KdTree(points).nearest_of_each(points, k));
  };
  EXPECT_EQ(spacing(row, 2), 4);  // the upper of the middle two of 1, 1, 2, 4, 8, 16
  EXPECT_EQ(spacing(row, 4), 4);
  row.pop_back();
  EXPECT_EQ(spacing(row, 2), 2);
  EXPECT_EQ(spacing({{1, 2, 3}}, 2), 0);
  EXPECT_EQ(spacing({}, 2), 0);
}

TEST(GrownSupportRadius, IsTheFirstPowerThatHoldsSix) {
  for (const auto& points : {shapes::random_cloud(400, 5), shapes::bumpy_sphere(3).vertices}) {
    const SupportRadius support = grown_support_radius(points, 0.01);
    const double steps = std::log(support.radius / (0.01 * bounding_radius(points))) / std::log(1.1);
    EXPECT_NEAR(steps, std::round(steps), 1e-9);
    EXPECT_GT(steps, 0.5);
    EXPECT_EQ(support.neighbours, static_cast<int>(brute_force_mean(points, support.radius)));
    EXPECT_GE(support.neighbours, 6);
    EXPECT_LT(brute_force_mean(points, support.radius / 1.1), 6);
  }
}

TEST(GrownSupportRadius, StaysWhereItHoldsEnough) {
  const auto cloud = shapes::random_cloud(400, 6);
  const SupportRadius support = grown_support_radius(cloud, 0.5);
  EXPECT_DOUBLE_EQ(support.radius, 0.5 * bounding_radius(cloud));
  EXPECT_GT(support.neighbours, 6);
}

TEST(GrownSupportRadius, FewerThanSevenPointsGrowUntilItHoldsThemAll) {
  for (std::size_t n = 1; n <= 6; ++n) {
    const auto few = shapes::random_cloud(n, 7);
    EXPECT_EQ(grown_support_radius(few, 0.01).neighbours, static_cast<int>(n) - 1) << n << " points";
  }
}

// A tenth of the smallest number is 0, and a product smaller than that cannot grow.
TEST(GrownSupportRadius, GrowsFromWhateverIsAboveZero) {
  auto cloud = shapes::random_cloud(50, 8);
  for (const double size : {1.0, 1e-49, 1e49}) {
    for (Vec3& point : cloud) point *= size;
    for (const double factor : {5e-324, 1e-300, 1e-150}) {
      const SupportRadius support = grown_support_radius(cloud, factor);
      EXPECT_GE(support.neighbours, 6) << size << " " << factor;
      EXPECT_GT(support.radius, 0);
    }
    for (Vec3& point : cloud) point /= size;
  }
}

struct Crowd {
  std::string name;
  std::vector<Vec3> points;
  bool is_refused;
};

std::vector<Vec3> moved(std::vector<Vec3> points, const Vec3& by, double scale = 1) {
  for (Vec3& p : points) p = scale * p + by;
  return points;
}

std::vector<Vec3> joined(std::vector<Vec3> points, const std::vector<Vec3>& more) {
  points.insert(points.end(), more.begin(), more.end());
  return points;
}

std::vector<Crowd> crowds() {
  const std::vector<Vec3> sphere = shapes::sphere(4).vertices;  // 2562
  std::vector<Vec3> line;
  for (int i = 0; i < 100000; ++i) line.emplace_back(i, 0, 0);
  std::vector<Vec3> clusters;
  for (int k = 0; k < 8; ++k)
    clusters = joined(clusters, moved(sphere, 1e4 * Vec3(k & 1, k >> 1 & 1, k >> 2)));
  const auto strays = [&](double distance, int count) {
    std::vector<Vec3> far;
    for (int k = 0; k < count; ++k) far.emplace_back(distance, k, 0);
    return joined(sphere, far);
  };
  return {{"a sphere", sphere, false},
          {"a straight line", line, false},
          {"one stray, not far", strays(20, 1), false},
          {"one stray", strays(1e4, 1), true},
          {"one stray, farther away than the digits of a double reach", strays(1e20, 1), true},
          {"a few strays", strays(-1e3, 12), true},
          {"two spheres far apart", joined(sphere, moved(sphere, Vec3(1e4, 0, 0))), true},
          {"eight of them", clusters, true},
          {"many points in one place", joined(sphere, std::vector<Vec3>(2562, Vec3::Zero())), true},
          {"a dense part among points far apart",
           joined(shapes::random_cloud(3000, 3), moved(sphere, Vec3(0.5, 0.5, 0.5), 1e-3)), true}};
}

TEST(GrownSupportRadius, RefusesACrowd) {
  for (const auto& [name, points, is_refused] : crowds()) {
    std::string found;
    try {
      EXPECT_GE(grown_support_radius(points, 0.02).neighbours, kMinMeanNeighbours) << name;
    } catch (const InputError& error) {
      found = error.what();
    }
    EXPECT_EQ(!found.empty(), is_refused) << name << ": " << found;
    // Reference: all pairs.
    if (points.size() > 6000) continue;
    const double radius = 0.02 * bounding_radius(points);
    const double most = most_mean_neighbours(points.size(), 0.02, 1);
    EXPECT_EQ(brute_force_mean(points, radius) > most, is_refused) << name;
    EXPECT_EQ(mean_neighbour_counts(KdTree(points), radius, radius, most).has_value(), !is_refused) << name;
  }
}

TEST(RequireFewNeighbours, LetsShapesPassThatFillTheirExtent) {
  EXPECT_EQ(most_mean_neighbours(10000, 0.02, 1), 1000);
  EXPECT_EQ(most_mean_neighbours(100000, 0.02, 1), 2500);
  EXPECT_EQ(most_mean_neighbours(100000, 1, 10), 50000);
  const std::vector<Vec3> sphere = shapes::sphere(4).vertices;
  const KdTree tree(sphere);
  for (const double radius : {0.0, 0.1, 0.9, 2.0, 1e9})
    EXPECT_NO_THROW(require_few_neighbours(sphere, tree, radius));
}

TEST(GrownSupportRadius, OfCoincidentPointsIsZeroAndRefusesNoPointsAndNumbersThatAreNone) {
  const SupportRadius support = grown_support_radius(std::vector<Vec3>(20, Vec3(1, 2, 3)), 0.01);
  EXPECT_EQ(support.radius, 0);
  EXPECT_EQ(support.neighbours, 19);
  EXPECT_THROW(grown_support_radius(std::vector<Vec3>{}, 0.01), InputError);
  EXPECT_THROW(grown_support_radius(std::vector<Vec3>{{0, 0, 0}, {1, kNan, 0}}, 0.01), InputError);
}

}  // namespace
}  // namespace salbench
