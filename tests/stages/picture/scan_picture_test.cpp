// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of scans; the camera and the light are those of meshes (picture_test.cpp).
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "stages/picture/picture.h"
#include "tests/support/shapes.h"

namespace salbench {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const RandomSource kRandom{2016, "1_3"};

struct ScannedSphere {
  Mesh mesh = shapes::sphere(1);  // tells which way is up
  Scan scan;
  Normals normals;
};

// A grid of rays from the distance 10 that meets the unit sphere, row by row.
ScannedSphere scanned_sphere(double step = 0.04, const Vec3& scanner = Vec3(6, 0, 8)) {
  ScannedSphere scanned;
  scanned.scan.camera = scanner;
  const Vec3 forward = -scanner.normalized(), right = forward.cross(Vec3::UnitY()).normalized(),
             up = right.cross(forward);
  for (double y = 1; y >= -1; y -= step)
    for (double x = -1; x <= 1; x += step) {
      const Vec3 ray = (forward + (x * right + y * up) / scanner.norm()).normalized();
      const double along = -ray.dot(scanner), below = along * along - scanner.squaredNorm() + 1;
      if (below < 0) continue;
      scanned.scan.points.push_back(scanner + (along - std::sqrt(below)) * ray);
      scanned.normals.push_back(scanned.scan.points.back());
    }
  return scanned;
}

Picture picture_of(const ScannedSphere& s, const PictureOptions& options) {
  return picture_of_scan(s.scan, s.normals, s.mesh, options, kRandom);
}

TEST(PictureOfScan, DiscsLeaveNoHoles) {
  for (const double turn : {0.0, 12.0, 20.0})
    for (const double step : {0.03, 0.1}) {
      const Picture picture = picture_of(scanned_sphere(step), {.size = 200, .scan_turn = turn});
      const auto shows = [&](int row, int column) {
        return picture.primitive[static_cast<std::size_t>(row * 200 + column)] >= 0;
      };
      // In every row what is seen is one piece, but for the ragged ends.
      for (int row = 30; row < 170; ++row) {
        int first = 0, last = 199;
        while (!shows(row, first)) ++first;
        while (!shows(row, last)) --last;
        const int ends = static_cast<int>(200 * step);
        for (int column = first + ends; column <= last - ends; ++column)
          ASSERT_TRUE(shows(row, column)) << turn << " " << step << ": " << row << " " << column;
      }
    }
}

TEST(PictureOfScan, APixelShowsThePointWhoseDiscItMeets) {
  const double step = 0.05;
  const ScannedSphere scanned = scanned_sphere(step);
  const Picture picture = picture_of(scanned, {.size = 150});
  const auto& m = picture.view_projection;
  std::size_t seen = 0;
  for (std::size_t pixel = 0; pixel < picture.pixels(); ++pixel) {
    const std::int32_t point = picture.primitive[pixel];
    if (point < 0) continue;
    ++seen;
    ASSERT_EQ(picture.weights[3 * pixel], 1);
    ASSERT_EQ(picture.weights[3 * pixel + 1] + picture.weights[3 * pixel + 2], 0);
    const Vec3& p = scanned.scan.points[static_cast<std::size_t>(point)];
    const auto row_of = [&](std::size_t r) {
      return m[4 * r] * p.x() + m[4 * r + 1] * p.y() + m[4 * r + 2] * p.z() + m[4 * r + 3];
    };
    const double w = row_of(3), column = (row_of(0) / w + 1) / 2 * 150, row = (1 - row_of(1) / w) / 2 * 150;
    const double reach = 10 * step;  // of a long disc at the outline, in radii of the sphere
    ASSERT_NEAR(column, static_cast<double>(pixel % 150) + 0.5, reach * 75);
    ASSERT_NEAR(row, static_cast<double>(pixel / 150) + 0.5, reach * 75);
    ASSERT_NEAR(static_cast<double>(picture.depth[pixel]), w, reach);
  }
  EXPECT_GT(seen, picture.pixels() / 2);
}

TEST(PictureOfScan, IsAsBrightAsTheSurface) {
  const Picture picture = picture_of(scanned_sphere(), {.size = 150, .scan_turn = 0});
  const Picture bare = picture_of(scanned_sphere(), {.size = 150, .scan_turn = 0, .occlusion_samples = 0});
  int darkened = 0;
  for (std::size_t i = 0; i < picture.pixels(); ++i)
    darkened += picture.shade[i] < bare.shade[i] - 10 ? 1 : 0;
  EXPECT_LT(darkened, 30) << "discs do not shadow each other";
  EXPECT_GE(*std::min_element(bare.shade.begin(), bare.shade.end()), 255 * PictureOptions().ambient - 1);
}

TEST(PictureOfScan, RefusesWhatCannotBeSeen) {
  const auto taking = [](const ScannedSphere& s) { return [s] { picture_of(s, {}); }; };
  EXPECT_THAT(taking({}), ThrowsMessage<InputError>(HasSubstr("the scan is empty")));
  ScannedSphere one = scanned_sphere();
  one.scan.points.resize(1);
  one.normals.resize(1);
  EXPECT_THAT(taking(one), ThrowsMessage<InputError>(HasSubstr("in one place")));
  ScannedSphere broken = scanned_sphere();
  broken.scan.points[4].x() = std::nan("");
  EXPECT_THAT(taking(broken), ThrowsMessage<InputError>(HasSubstr("finite")));
  ScannedSphere two = scanned_sphere();
  two.scan.points.resize(2);
  two.normals.resize(2);
  EXPECT_NO_THROW(taking(two)());
}

}  // namespace
}  // namespace salbench
