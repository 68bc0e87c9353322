// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/support.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "stages/core/mesh_ops.h"
#include "tests/support/shapes.h"

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
    const auto [within_small, within] = mean_neighbour_counts(cloud, KdTree(cloud), small, radius);
    EXPECT_DOUBLE_EQ(within_small, brute_force_mean(cloud, small));
    EXPECT_DOUBLE_EQ(within, brute_force_mean(cloud, radius));
  }
  EXPECT_EQ(mean_neighbour_counts(cloud, KdTree(cloud), 0, 0)[1], 0);
}

TEST(MedianSpacing, IsTheDistanceToTheNearestOther) {
  std::vector<Vec3> row;  // gaps 1, 2, 4, 8, 16
  for (const double x : {0, 1, 3, 7, 15, 31}) row.emplace_back(x, 0, 0);
  const auto spacing = [](const std::vector<Vec3>& points, std::size_t k) {
    return median_spacing(KdTree(points).nearest_of_each(points, k));
  };
  EXPECT_EQ(spacing(row, 2), 4);  // the upper one of 1, 1, 2, 4, 8, 16 in the middle
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

// A tenth of the smallest number is nothing, and of a smaller product nothing is left to grow.
TEST(GrownSupportRadius, GrowsFromWhateverIsAboveZero) {
  auto cloud = shapes::random_cloud(50, 8);
  for (const double size : {1.0, 1e-200, 1e150}) {
    for (Vec3& point : cloud) point *= size;
    for (const double factor : {5e-324, 1e-300, 1e-150}) {
      const SupportRadius support = grown_support_radius(cloud, factor);
      EXPECT_GE(support.neighbours, 6) << size << " " << factor;
      EXPECT_GT(support.radius, 0);
    }
    for (Vec3& point : cloud) point /= size;
  }
}

TEST(GrownSupportRadius, OfCoincidentPointsIsZero) {
  const std::vector<Vec3> same(20, Vec3(1, 2, 3));
  const SupportRadius support = grown_support_radius(same, 0.01);
  EXPECT_EQ(support.radius, 0);
  EXPECT_EQ(support.neighbours, 19);
}

TEST(GrownSupportRadius, RefusesNoPointsAndNumbersThatAreNone) {
  EXPECT_THROW(grown_support_radius(std::vector<Vec3>{}, 0.01), InputError);
  auto cloud = shapes::random_cloud(20, 8);
  cloud[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(grown_support_radius(cloud, 0.01), InputError);
}

}  // namespace
}  // namespace salbench
