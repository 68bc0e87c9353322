// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/picture/raster.h"

#include <Eigen/LU>

#include "stages/core/rng.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

constexpr ImagePlane kPlane{40, 0.4};

// Within the field of view and around it.
Vec3 random_point(Rng& rng) {
  const double depth = 2 + 3 * rng.uniform();
  return {depth * (1.2 * rng.uniform() - 0.6), depth * (1.2 * rng.uniform() - 0.6), depth};
}

// Intersection of a ray with a face, by solving for it: depth and least corner weight, negative outside.
struct Meeting {
  double depth, least;
};
Meeting meeting(const std::vector<Vec3>& points, const Triangle& face, const Vec3& ray) {
  Eigen::Matrix3d corners;
  for (int k = 0; k < 3; ++k) corners.col(k) = points[index(face[index(k)])];
  const Vec3 weights = corners.inverse() * ray;  // at depth 1 of the ray
  return {1 / weights.sum(), weights.minCoeff() / std::abs(weights.sum())};
}

// Ignores cells whose ray passes within rounding of an edge.
TEST(SeeFaces, EqualsAllRaysAgainstAllFaces) {
  Rng rng(1, "faces", "");
  std::vector<Vec3> points;
  std::vector<Triangle> faces;
  for (std::int32_t f = 0; f < 30; ++f) {
    for (int k = 0; k < 3; ++k) points.push_back(random_point(rng));
    faces.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  for (const std::size_t count : {1U, 3U, 30U}) {
    const std::vector<Triangle> some(faces.end() - static_cast<std::ptrdiff_t>(count), faces.end());
    const Seen seen = see_faces(points, some, kPlane);
    int hits = 0, doubtful = 0;
    for (int cell = 0; cell < static_cast<int>(kPlane.cells()); ++cell) {
      std::pair<double, std::int32_t> nearest = {kInfinity, -1};
      bool on_edge = false;
      for (std::size_t f = 0; f < some.size(); ++f) {
        const auto [depth, least] = meeting(points, some[f], kPlane.ray_of_cell(cell));
        on_edge |= depth > 0 && std::abs(least) < 1e-9;
        if (depth > 0 && least >= 0) nearest = std::min(nearest, {depth, static_cast<std::int32_t>(f)});
      }
      doubtful += on_edge ? 1 : 0;
      if (on_edge) continue;
      const auto at = index(cell);
      ASSERT_EQ(seen.primitive[at], nearest.second) << cell;
      if (nearest.second < 0) {
        ASSERT_EQ(seen.depth[at], std::numeric_limits<float>::infinity());
        continue;
      }
      ASSERT_NEAR(seen.depth[at], nearest.first, 1e-6 * nearest.first);
      ++hits;
    }
    EXPECT_GT(hits, 50);
    EXPECT_LT(doubtful, 5);
  }
}

TEST(SeeFaces, FillsThePictureToItsLastCell) {
  const std::vector<Vec3> points = {{-9, -9, 2}, {9, -9, 2}, {0, 30, 2}};
  const Seen seen = see_faces(points, std::vector<Triangle>{{0, 1, 2}}, kPlane);
  EXPECT_EQ(std::count(seen.primitive.begin(), seen.primitive.end(), 0), 1600);
}

}  // namespace
}  // namespace salbench
