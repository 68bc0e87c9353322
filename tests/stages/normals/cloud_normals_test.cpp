// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/normals/normals.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

// Largest angle of all points to the outward normal of the unit sphere, in degrees.
double largest_error(const std::vector<Vec3>& points, const Normals& normals) {
  double largest = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    largest = std::max(largest, std::acos(std::clamp(points[i].normalized().dot(normals[i]), -1.0, 1.0)));
  return largest * 180 / std::numbers::pi;
}

TEST(CloudNormals, AreItsOwnWhereItHasThem) {
  const PointCloud cloud{.points = shapes::random_cloud(40, 1), .normals = shapes::random_normals(40, 2)};
  EXPECT_EQ(cloud_normals(cloud), cloud.normals);
}

TEST(CloudNormals, PointOutwardsWithoutAViewpointWhateverTheOptionsOfScansSay) {
  const PointCloud cloud{.points = shapes::sphere(3).vertices};
  for (const auto orientation : {ScanOrientation::camera, ScanOrientation::hoppe})
    EXPECT_LT(largest_error(cloud.points, cloud_normals(cloud, {.orientation = orientation})), 8);
}

TEST(CloudNormals, OfTwoSeparatePartsPointOutwardsOnBoth) {
  PointCloud cloud{.points = shapes::sphere(3).vertices};
  const std::vector<Vec3> one = cloud.points;
  for (const Vec3& p : one) cloud.points.push_back(p + Vec3(20, 3, 0));
  const Normals normals = cloud_normals(cloud);
  EXPECT_LT(largest_error(one, {normals.begin(), normals.begin() + std::ssize(one)}), 8);
  EXPECT_LT(largest_error(one, {normals.begin() + std::ssize(one), normals.end()}), 8);
}

TEST(CloudNormals, AreThoseOfAScanWhereTheViewpointIsKnown) {
  const std::vector<Vec3> points = shapes::sphere(3).vertices;
  const Vec3 viewpoint(0.1, 0, 0);  // inside: all normals point inwards
  const PointCloud cloud{.points = points, .viewpoint = viewpoint};
  const Normals normals = cloud_normals(cloud);
  EXPECT_EQ(normals, scan_normals({points, viewpoint}));
  EXPECT_GT(largest_error(points, normals), 172);
}

TEST(CloudNormals, HaveUnitLengthOnDuplicateAndCollinearPoints) {
  PointCloud cloud{.points = std::vector<Vec3>(30, Vec3(1, 2, 3))};
  for (int i = 0; i < 30; ++i) cloud.points.emplace_back(i, 0, 0);
  for (const Vec3& normal : cloud_normals(cloud)) EXPECT_NEAR(normal.norm(), 1, 1e-12);
}

}  // namespace
}  // namespace salbench
