// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/point_cloud.h"

#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

PointCloud random_cloud(std::size_t n) {
  return {.points = shapes::random_cloud(n, 1), .normals = shapes::random_normals(n, 2)};
}

TEST(PointCloud, ASoundCloudIsLeftAsItIs) {
  const PointCloud cloud = random_cloud(50);
  const CheckedCloud checked = check_cloud(cloud);
  EXPECT_EQ(checked.cloud.points, cloud.points);
  EXPECT_EQ(checked.cloud.normals, cloud.normals);  // bit for bit: they have unit length within rounding
  EXPECT_THAT(checked.cloud.dropped, IsEmpty());
  EXPECT_THAT(checked.warnings, IsEmpty());
}

TEST(PointCloud, DropsPointsWithoutAPositionAndRemembersTheirNumbers) {
  const PointCloud sound = random_cloud(13);
  PointCloud cloud = sound;
  cloud.points[0].y() = kNan;
  cloud.points[5].x() = -kInfinity;
  cloud.normals[5] = Vec3::Constant(kNan);
  const CheckedCloud checked = check_cloud(cloud);
  EXPECT_THAT(checked.cloud.points, SizeIs(11));
  EXPECT_THAT(checked.cloud.normals, SizeIs(11));
  EXPECT_THAT(checked.cloud.dropped, ElementsAre(0, 5));
  EXPECT_EQ(checked.cloud.size_in_file(), 13U);
  EXPECT_THAT(checked.warnings, ElementsAre(StartsWith("2 of 13 points dropped")));
  const auto numbers = numbers_left(checked.cloud);
  EXPECT_THAT(numbers, ElementsAre(-1, 0, 1, 2, 3, -1, 4, 5, 6, 7, 8, 9, 10));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i] < 0) continue;
    EXPECT_EQ(checked.cloud.points[index(numbers[i])], sound.points[i]);
    EXPECT_EQ(checked.cloud.normals[index(numbers[i])], sound.normals[i]);
  }
}

TEST(PointCloud, ValuesAndPicksFollowTheNumbers) {
  PointCloud cloud = random_cloud(12);
  cloud.points[1].z() = kNan;
  cloud = check_cloud(cloud).cloud;
  EXPECT_THAT(values_left(cloud, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}),
              ElementsAre(0, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11));
  EXPECT_THAT(picks_left(cloud, {{0, 2, 2}, {}, {11}}),
              ElementsAre(ElementsAre(0, 1, 1), IsEmpty(), ElementsAre(10)));
  const std::vector<std::vector<std::int32_t>> dropped = {{0}, {1}};
  EXPECT_THAT([&] { picks_left(cloud, dropped); }, Refuses("participant 1 picked point 1 (0-based)"));
}

TEST(PointCloud, MakesNormalsUnitLengthOnce) {
  PointCloud cloud = random_cloud(20);
  for (Vec3& normal : cloud.normals) normal = (normal * 3.7).cast<float>().cast<double>();
  cloud.normals[3] *= 1e-200;
  const PointCloud once = check_cloud(cloud).cloud;
  for (const Vec3& normal : once.normals) EXPECT_NEAR(normal.norm(), 1, 1e-15);
  EXPECT_EQ(check_cloud(once).cloud.normals, once.normals);
}

TEST(PointCloud, NormalsThatAreAllZeroCountAsNotGiven) {
  PointCloud cloud = random_cloud(20);
  for (Vec3& normal : cloud.normals) normal.setZero();
  const CheckedCloud checked = check_cloud(cloud);
  EXPECT_THAT(checked.cloud.normals, IsEmpty());
  EXPECT_THAT(checked.warnings, ElementsAre(HasSubstr("all normals in the file are zero")));
}

TEST(PointCloud, RefusesWhatNothingCanBeComputedFrom) {
  const auto changed = [](std::size_t n, const auto& change) {
    PointCloud cloud = random_cloud(n);
    change(cloud);
    return cloud;
  };
  std::vector<std::pair<PointCloud, const char*>> rows = {
      {{}, "0 points"},
      {random_cloud(8), "8 points"},
      {changed(9, [](PointCloud& cloud) { cloud.points[8] = Vec3::Constant(kNan); }), "8 points"},
      {{.points = std::vector<Vec3>(30, Vec3(1, 2, 3))}, "in one place"},
      {changed(9, [](PointCloud& cloud) { cloud.points[3].x() = 1e60; }), "point 3 (0-based)"},
      {changed(9,
               [](PointCloud& cloud) {
                 for (Vec3& p : cloud.points) p *= 1e-60;
               }),
       "scale the shape"}};
  for (const double far : {1e60, 1e300, kInfinity, kNan})
    rows.emplace_back(changed(50, [&](PointCloud& cloud) { cloud.viewpoint = Vec3(0, far, 0); }),
                      "viewpoint");
  for (const Vec3& bad : {Vec3(0, 0, 0), Vec3(0, kNan, 1), Vec3(kInfinity, 0, 0)})
    rows.emplace_back(changed(20,
                              [&](PointCloud& cloud) {
                                cloud.points[2].x() = kNan;
                                cloud.normals[4] = cloud.normals[9] = bad;
                              }),
                      "2 points have a zero or not finite normal, the first is point 4");
  for (const auto& [cloud, why] : rows) EXPECT_THAT([&c = cloud] { check_cloud(c); }, Refuses(why));
}

}  // namespace
}  // namespace salbench
