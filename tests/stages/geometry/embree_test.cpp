// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/embree.h"

#include "tests/support/test.h"

namespace salbench {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

TEST(Embree, ARayIsHiddenBetweenItsEndsAlone) {
  const std::vector<Vec3> points = {{-1, -1, 2}, {3, -1, 2}, {-1, 3, 2}};
  const std::vector<Triangle> faces = {{0, 1, 2}};
  const std::vector<Vec3> centre = {{0, 0, 2}}, normal = {{0, 0, 1}};
  const std::vector<double> radius = {0.5};
  for (const bool as_discs : {false, true}) {
    const embree::Scene scene =
        as_discs ? embree::scene_of_discs(centre, normal, radius) : embree::scene_of_triangles(points, faces);
    const auto hidden = [&](const Eigen::Vector3f& from, float near, float far) {
      return embree::occluded(scene, from, {0, 0, 1}, near, far);
    };
    EXPECT_TRUE(hidden({0, 0, 0}, 0, kFar));
    EXPECT_TRUE(hidden({0.3F, 0.3F, 0}, 0, 2.5F));
    EXPECT_FALSE(hidden({0, 0, 0}, 0, 1.5F));
    EXPECT_FALSE(hidden({0, 0, 0}, 2.5F, kFar));
    EXPECT_FALSE(hidden({0, 0, 3}, 0, kFar));
    EXPECT_FALSE(hidden({5, 5, 0}, 0, kFar));
  }
}

// More points than the library accepts; none of them is read.
TEST(Embree, AnErrorOfTheLibraryIsThrownWhereItHappens) {
  const Vec3 point(0, 0, 0);
  const std::span<const Vec3> too_many(&point, std::size_t{1} << 33U);
  EXPECT_THAT([&] { embree::scene_of_triangles(too_many, {}); },
              ThrowsMessage<std::runtime_error>(HasSubstr("Embree")));
}

}  // namespace
}  // namespace salbench
