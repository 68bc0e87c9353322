// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/sd.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "stages/core/mesh_ops.h"
#include "tests/stages/models/surfaces.h"
#include "tests/support/options.h"
#include "tests/support/shapes.h"

namespace salbench {
namespace {

using testing::DoubleEq;
using testing::Each;
using testing::ElementsAre;

ScalarField sd(const Mesh& mesh) { return sd_saliency(mesh.vertices, mesh.faces, {}); }

double radius_squared(const std::vector<Vec3>& points) { return std::pow(bounding_radius(points), 2); }

// A square of n x n points per unit whose abscissae are squared: of x there are n^2 / (2 sqrt(x)) per area.
TEST(Sd, OfAGradedGridIsItsDensity) {
  constexpr int kCells = 40;
  Mesh mesh = shapes::grid(kCells);
  for (Vec3& v : mesh.vertices) v.x() *= v.x();
  const ScalarField density = sd(mesh);
  for (int y = 1; y < kCells; ++y)
    for (int x = 1; x < kCells; ++x) {
      const std::size_t i = static_cast<std::size_t>(y * (kCells + 1) + x);
      const double per_area = kCells * kCells / (2 * std::sqrt(mesh.vertices[i].x()));
      EXPECT_NEAR(density[i] / radius_squared(mesh.vertices), per_area, 1e-9 * per_area) << x << " " << y;
    }
}

// Rings whose points are as far from each other as from those of the next rings: their density falls with the
// squared distance from the middle. The eight neighbours reach to the diagonal of a cell.
TEST(Sd, OfPointsOnGrowingRingsIsTheirDensity) {
  constexpr int kColumns = 90, kRows = 60;
  constexpr double kStep = 2 * std::numbers::pi / kColumns;
  const std::vector<Vec3> points =
      shapes::wrapped(kColumns, kRows, false, [](double u, int row) {
        return Vec3(std::exp(kStep * row) * std::cos(u), std::exp(kStep * row) * std::sin(u), 0);
      }).vertices;
  const ScalarField density = sd_saliency_of_points(points, {.neighbours = 8});
  for (std::size_t i = kColumns; i < points.size() - kColumns; ++i) {
    const double cell = std::pow(kStep, 2) * points[i].squaredNorm();
    const double per_cell = density[i] / radius_squared(points) * cell;
    EXPECT_NEAR(per_cell, 8 / (2 * std::numbers::pi), 0.1) << i;
    EXPECT_NEAR(
        per_cell,
        density[kColumns] / radius_squared(points) * std::pow(kStep, 2) * points[kColumns].squaredNorm(),
        1e-9);
  }
}

TEST(Sd, OfAMeshIsOneOverAThirdOfTheFacesAround) {
  const Mesh mesh = {{{0, 0, 0}, {4, 0, 0}, {0, 3, 0}, {0, 0, 3}, {9, 9, 9}}, {{0, 1, 2}, {0, 3, 1}}};
  const double unit = radius_squared(mesh.vertices) / 2;  // a third of a face has the area 2
  const ScalarField density = sd(mesh);
  EXPECT_THAT(density,
              ElementsAre(DoubleEq(unit / 2), DoubleEq(unit / 2), DoubleEq(unit), DoubleEq(unit), 0));
  EXPECT_THAT(sd_saliency(mesh.vertices, {}, {}), Each(0));
}

TEST(Sd, OfFewPointsHasAllOthersInTheDisc) {
  const std::vector<Vec3> two = {{0, 0, 0}, {2, 0, 0}};
  EXPECT_THAT(sd_saliency_of_points(two, {}), Each(DoubleEq(1 / (4 * std::numbers::pi))));
}

TEST(SdDegenerate, PointsInOnePlaceAreAsDenseAsTheDensestOther) {
  const std::vector<Vec3> points = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {3, 0, 0}};
  const ScalarField density = sd_saliency_of_points(points, {.neighbours = 2});
  EXPECT_GT(density[3], density[4]);
  EXPECT_THAT((std::vector<double>{density[0], density[1], density[2]}), Each(density[3]));
  const std::vector<Vec3> pairs = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0, 0}};
  EXPECT_THAT(sd_saliency_of_points(pairs, {.neighbours = 1}), Each(0));
}

TEST(SdDegenerate, WhatHasNoExtentOrNoSuchPoint) {
  const std::vector<Vec3> one = {{1, 2, 3}},
                          far = {{0, 0, 0}, {1, 0, std::numeric_limits<double>::infinity()}};
  const Faces beyond = {{0, 1, 2}};
  for (const std::vector<Vec3>& points : {std::vector<Vec3>{}, one, std::vector<Vec3>{one[0], one[0]}, far}) {
    EXPECT_THROW(sd_saliency(points, {}, {}), InputError);
    EXPECT_THROW(sd_saliency_of_points(points, {}), InputError);
  }
  EXPECT_THROW(sd_saliency(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}}, beyond, {}), InputError);
}

TEST(SdOptions, AreChecked) { EXPECT_EQ(wrong_field(SdOptions{.neighbours = 0}), "neighbours"); }

}  // namespace
}  // namespace salbench
