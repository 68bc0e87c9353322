// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of point clouds, whose points lie on no grid.
#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "stages/picture/picture.h"
#include "tests/support/shapes.h"

namespace salbench {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const RandomSource kRandom{2016, "1"};

// Points anywhere on the unit sphere, denser on one half.
PointCloud sphere_cloud(std::size_t n) {
  PointCloud cloud{.points = shapes::random_normals(n, 5)};
  for (const Vec3& p : shapes::random_normals(n, 6))
    if (p.x() > 0) cloud.points.push_back(p);
  cloud.normals = cloud.points;
  return cloud;
}

Picture picture_of(const PointCloud& cloud, const PictureOptions& options) {
  return picture_of_cloud(cloud, cloud.normals, {}, options, kRandom);
}

TEST(PictureOfCloud, DiscsLeaveHardlyAnyHolesAndHideWhatIsBehind) {
  const PointCloud cloud = sphere_cloud(4000);
  const Picture picture = picture_of(cloud, {.size = 200});
  const auto& m = picture.view_projection;
  std::size_t inside = 0, open = 0;
  for (int row = 0; row < 200; ++row)
    for (int column = 0; column < 200; ++column) {
      if (std::hypot(row + 0.5 - 100, column + 0.5 - 100) > 80)
        continue;  // the sphere fills 92 % of the width
      ++inside;
      const std::int32_t point = picture.primitive[static_cast<std::size_t>(row * 200 + column)];
      const Vec3 p = point < 0 ? Vec3::Zero() : cloud.points[static_cast<std::size_t>(point)];
      // Seen of the far half, or nothing at all; m[15] is the depth of the centre.
      open += m[12] * p.x() + m[13] * p.y() + m[14] * p.z() >= 0 ? 1U : 0U;
    }
  EXPECT_LT(static_cast<double>(open), 0.01 * static_cast<double>(inside));
}

TEST(PictureOfCloud, IsTakenFromNearAViewpointOutsideOfTheCloudAlone) {
  PointCloud cloud = sphere_cloud(500);
  const PictureOptions options{.size = 60, .scan_turn = 0};
  const Picture without = picture_of(cloud, options);
  cloud.viewpoint = Vec3(0.2, 0, 0);
  EXPECT_EQ(picture_of(cloud, options).view_projection, without.view_projection);
  cloud.viewpoint = Vec3(0, 0, -7);
  const auto m = picture_of(cloud, options).view_projection;
  EXPECT_GT(m[14], 0.99);  // depth grows along z
}

TEST(PictureOfCloud, ShowsTheBackOfASurfaceAsWell) {
  PointCloud cloud = sphere_cloud(2000);
  const Picture outwards = picture_of(cloud, {.size = 60});
  for (Vec3& normal : cloud.normals) normal = -normal;
  EXPECT_EQ(picture_of(cloud, {.size = 60}).shade, outwards.shade);
}

TEST(PictureOfCloud, RefusesWhatCannotBeSeen) {
  EXPECT_THAT([] { picture_of({}, {}); }, ThrowsMessage<InputError>(HasSubstr("the point cloud is empty")));
  PointCloud broken = sphere_cloud(50);
  broken.points[3].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { picture_of(broken, {}); }, ThrowsMessage<InputError>(HasSubstr("finite")));
}

}  // namespace
}  // namespace salbench
