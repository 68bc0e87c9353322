// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/picture/picture.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "stages/geometry/mesh_ops.h"
#include "tests/support/rays.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"
#include "tests/support/threads.h"

namespace salbench {
namespace {

constexpr PictureOptions kSmall{.size = 120};
const RandomSource kRandom{2016, "1"};

// Without symmetry, with parts that occlude others, off centre, and in a unit of its own.
Mesh two_bodies() {
  Mesh small = shapes::tetrahedron();
  for (Vec3& v : small.vertices) v *= 0.4;
  Mesh mesh = shapes::joined(shapes::bumpy_sphere(3), small, {0.5, 0.8, 1.1});
  for (Vec3& v : mesh.vertices) v = 20 * v + Vec3(70, -30, 20);
  return mesh;
}

// --- the camera as readers of the file have it: from view_projection alone --------------------------------

struct Projection {
  explicit Projection(const Picture& picture) : size(picture.size) {
    for (int i = 0; i < 16; ++i) matrix(i / 4, i % 4) = picture.view_projection[index(i)];
  }
  struct Place {
    double column, row, depth;
  };
  Place of(const Vec3& p) const {
    const Eigen::Vector4d clip = matrix * p.homogeneous();
    return {(clip.x() / clip.w() + 1) / 2 * size, (1 - clip.y() / clip.w()) / 2 * size, clip.w()};
  }
  Vec3 point(double column, double row, double depth) const {  // the inverse
    const double x = (2 * column / size - 1) * depth, y = (1 - 2 * row / size) * depth;
    Eigen::Matrix3d system;
    system << matrix.block<1, 3>(0, 0), matrix.block<1, 3>(1, 0), matrix.block<1, 3>(3, 0);
    return system.inverse() * (Vec3(x, y, depth) - Vec3(matrix(0, 3), matrix(1, 3), matrix(3, 3)));
  }
  Vec3 camera() const { return point(0, 0, 0); }

  int size;
  Eigen::Matrix4d matrix;
};

template <class Visit>  // visit(pixel, column, row) for all pixels that show the shape
void for_each_seen(const Picture& picture, const Visit& visit) {
  for (std::size_t i = 0; i < picture.pixels(); ++i)
    if (picture.primitive[i] >= 0)
      visit(i, static_cast<int>(i) % picture.size, static_cast<int>(i) / picture.size);
}

Vec3 position(const Mesh& mesh, const Picture& picture, std::size_t pixel) {
  Vec3 p = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k)
    p += static_cast<double>(picture.weights[3 * pixel + k]) *
         mesh.vertices[index(mesh.faces[index(picture.primitive[pixel])][k])];
  return p;
}

std::size_t seen_pixels(const Picture& picture) {
  std::size_t count = 0;
  for_each_seen(picture, [&](auto...) { ++count; });
  return count;
}

TEST(PictureOfMesh, WhatAPixelShowsLiesInIt) {
  for (const Mesh& mesh : {two_bodies(), shapes::box()}) {
    const Picture picture = picture_of_mesh(mesh, kSmall, kRandom);
    const Projection projection(picture);
    ASSERT_GT(seen_pixels(picture), picture.pixels() / 5);
    for_each_seen(picture, [&](std::size_t pixel, int column, int row) {
      const float* w = &picture.weights[3 * pixel];
      ASSERT_EQ(w[0] + w[1] + w[2], 1.0F);
      ASSERT_TRUE(w[0] >= 0 && w[1] >= 0 && w[2] >= 0);
      const auto place = projection.of(position(mesh, picture, pixel));
      const double reach = picture.coverage[pixel] == 255 ? 0.02 : 0.4;
      ASSERT_NEAR(place.column, column + 0.5, reach);
      ASSERT_NEAR(place.row, row + 0.5, reach);
      ASSERT_NEAR(place.depth, static_cast<double>(picture.depth[pixel]), 1e-3 * place.depth);
    });
  }
}

TEST(PictureOfMesh, ShowsTheNearestFace) {
  const Mesh mesh = two_bodies();
  const Picture picture = picture_of_mesh(mesh, {.size = 60}, kRandom);
  const Projection projection(picture);
  constexpr double half_a_step = 0x1.1p-16;  // relative to the radius, with the rounding to float
  const double radius = bounding_radius(mesh.vertices);
  std::size_t differ = 0, compared = 0;
  for (int row = 0; row < picture.size; ++row)
    for (int column = 0; column < picture.size; ++column) {
      const auto pixel = index(row * picture.size + column);
      if (picture.coverage[pixel] != 0 && picture.coverage[pixel] != 255) continue;
      const Vec3 from = projection.camera();
      const FirstHit hit = met_by(mesh, from, projection.point(column + 0.5, row + 0.5, 1) - from);
      ++compared;
      differ += static_cast<std::int32_t>(hit.face) != picture.primitive[pixel] ? 1U : 0U;  // -1: none
      if (!hit) continue;
      ASSERT_NEAR(static_cast<double>(picture.depth[pixel]), hit.depth, half_a_step * radius);
    }
  EXPECT_GT(compared, 3000U);
  EXPECT_EQ(differ, 0U);
}

TEST(PictureOfMesh, ClipSpaceHoldsTheShapeFromItsNearestToItsFarthestPoint) {
  Mesh mesh = shapes::sphere(4);
  for (Vec3& v : mesh.vertices) v = 20 * v + Vec3(70, -30, 20);
  const Projection projection(picture_of_mesh(mesh, {.size = 16}, kRandom));
  double nearest = 2, farthest = -2;
  for (const Vec3& v : mesh.vertices) {
    const Eigen::Vector4d clip = projection.matrix * v.homogeneous();
    nearest = std::min(nearest, clip.z() / clip.w());
    farthest = std::max(farthest, clip.z() / clip.w());
  }
  EXPECT_NEAR(nearest, -1, 0.02);
  EXPECT_NEAR(farthest, 1, 0.02);
  EXPECT_GE(nearest, -1);
  EXPECT_LE(farthest, 1);
}

TEST(PictureOfMesh, AClosedShapeHasNoHolesInItsOutline) {
  // A box from the front: its edges pass through the centres of cells.
  const PictureOptions front{.size = 121, .azimuth = 0, .elevation = 0, .margin = 0.1};
  const Picture picture = picture_of_mesh(shapes::box(), front, kRandom);
  int filled = 0;
  for_each_seen(picture,
                [&](std::size_t pixel, int, int) { filled += picture.coverage[pixel] == 255 ? 1 : 0; });
  EXPECT_NEAR(filled, 0.8 * 121 * 0.8 * 121, 2 * 121);
  for (int row = 20; row < 101; ++row)
    for (int column = 20; column < 101; ++column)
      ASSERT_EQ(picture.coverage[index(row * 121 + column)], 255) << row << " " << column;
}

TEST(PictureOfMesh, TheShapeFillsThePictureUpToTheMargin) {
  Mesh mesh = two_bodies();
  mesh.vertices.emplace_back(1e4, 0, 0);  // without a face
  mesh.vertices.emplace_back(std::nan(""), 0, 0);
  for (const double field : {5.0, 30.0, 60.0}) {
    const Picture picture =
        picture_of_mesh(mesh, {.size = 200, .field_of_view = field, .margin = 0.05}, kRandom);
    int left = 200, right = -1, top = 200, bottom = -1;
    for_each_seen(picture, [&](std::size_t, int column, int row) {
      left = std::min(left, column), right = std::max(right, column);
      top = std::min(top, row), bottom = std::max(bottom, row);
    });
    EXPECT_GE(std::min(left, top), 9);
    EXPECT_LE(std::max(right, bottom), 190);
    EXPECT_GE(std::max(right - left, bottom - top), 176) << field;
    EXPECT_NEAR(left + right, 199, 10);  // tips are finer than a pixel
    EXPECT_NEAR(top + bottom, 199, 10);
  }
}

TEST(PictureOfMesh, FacesHaveNoBack) {
  const Mesh mesh = two_bodies();
  Mesh turned = mesh;
  for (std::size_t f = 0; f < turned.faces.size(); f += 3) std::swap(turned.faces[f][1], turned.faces[f][2]);
  const Picture one = picture_of_mesh(mesh, kSmall, kRandom),
                other = picture_of_mesh(turned, kSmall, kRandom);
  EXPECT_EQ(one.primitive, other.primitive);
  EXPECT_EQ(one.depth, other.depth);
  EXPECT_EQ(one.coverage, other.coverage);
  for (std::size_t i = 0; i < one.pixels(); ++i) ASSERT_NEAR(one.shade[i], other.shade[i], 1);
}

TEST(PictureOfMesh, LightFollowsTheLampAndAmbientOcclusionDarkensHollowsOnly) {
  const PictureOptions plain{.size = 120, .occlusion_samples = 0};
  const auto darkest = [](const Picture& picture) { return *std::ranges::min_element(picture.shade); };
  const Picture ball = picture_of_mesh(shapes::sphere(5), kSmall, kRandom);
  const Picture bare = picture_of_mesh(shapes::sphere(5), plain, kRandom);
  for (std::size_t i = 0; i < ball.pixels(); ++i) ASSERT_NEAR(ball.shade[i], bare.shade[i], 1) << "convex";
  EXPECT_GE(darkest(bare), static_cast<int>(255 * plain.ambient));
  EXPECT_GT(bare.shade[40 * 120 + 40], bare.shade[80 * 120 + 80] + 40) << "the lamp is to the upper left";

  // Two walls at right angles: half of the sky at the foot of one is behind the other.
  Mesh corner{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}},
              {{0, 1, 2}, {1, 3, 2}, {0, 4, 1}, {1, 4, 5}}};
  const PictureOptions close{.size = 121,
                             .up = PictureUp::y,
                             .azimuth = 0,
                             .elevation = 45,
                             .ambient = 1,
                             .occlusion_samples = 16,
                             .occlusion_reach = 100,
                             .occlusion_strength = 1};
  const Picture walls = picture_of_mesh(corner, close, kRandom);
  EXPECT_NEAR(walls.shade[60 * 121 + 60], 255 * 0.5, 20) << "in the corner";
  EXPECT_GT(walls.shade[20 * 121 + 60], 200) << "above it";
}

TEST(PictureOfMesh, TheAxisThatPointsUpShowsMoreOfTheSurface) {
  Mesh plate =
      shapes::grid(4);  // in the plane z = 0: seen from above where z is up, from the front where y is
  const auto seen = [&](PictureUp up) {
    return seen_pixels(picture_of_mesh(plate, {.size = 120, .up = up}, kRandom));
  };
  EXPECT_EQ(seen(PictureUp::automatic), seen(PictureUp::y));
  EXPECT_NE(seen(PictureUp::y), seen(PictureUp::z));
  for (Vec3& v : plate.vertices) std::swap(v.y(), v.z());
  EXPECT_EQ(seen(PictureUp::automatic), seen(PictureUp::z));
}

TEST(PictureOfMesh, DoesNotDependOnOtherThreadsAndTheSeedMovesTheShadeAlone) {
  const Mesh mesh = two_bodies();
  const auto [primitive, weights, shade] = same_in_threads_at_once([&] {
    const Picture picture = picture_of_mesh(mesh, kSmall, kRandom);
    return std::tuple(picture.primitive, picture.weights, picture.shade);
  });
  const Picture other = picture_of_mesh(mesh, kSmall, {7, "1"});
  EXPECT_EQ(other.primitive, primitive);
  EXPECT_NE(other.shade, shade);
  for (std::size_t i = 0; i < other.pixels(); ++i) ASSERT_NEAR(other.shade[i], shade[i], 40);
}

TEST(PictureOfMesh, RefusesWhatCannotBeSeen) {
  const auto taking = [](const Mesh& mesh) { return [mesh] { picture_of_mesh(mesh, kSmall, kRandom); }; };
  EXPECT_NO_THROW(taking({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0.1}}, {{0, 1, 2}}})()) << "a single face";
  EXPECT_THAT(taking({}), Refuses("the mesh is empty"));
  EXPECT_THAT(taking({{{1, 2, 3}}, {{0, 0, 0}}}), Refuses("in one place"));
  EXPECT_THAT(taking({{{0, 0, 0}, {1e-200, 0, 0}, {0, 1e-200, 0}}, {{0, 1, 2}}}),
              Refuses("expected at least 1e-50"));
  EXPECT_THAT(taking({{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{0, 1, 2}}}), Refuses("no pixel shows the mesh"));
  Mesh broken = shapes::tetrahedron();
  broken.vertices[2].y() = kInfinity;
  EXPECT_THAT(taking(broken), Refuses("finite"));
  broken.vertices[2].y() = 1e200;
  EXPECT_THAT(taking(broken), Refuses("expected at most 1e+50"));
}

}  // namespace
}  // namespace salbench
