// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/nv.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "stages/core/mesh_ops.h"
#include "stages/core/support.h"
#include "stages/normals/normals.h"
#include "tests/stages/models/surfaces.h"
#include "tests/support/options.h"

namespace salbench {
namespace {

using testing::DoubleNear;
using testing::Each;
using testing::ElementsAre;
using testing::Pointwise;

ScalarField nv(const Mesh& mesh, const NvOptions& options = {}) {
  return nv_saliency(mesh.vertices, mesh_normals(mesh), options);
}

// One minus the mean dot product, every point against every other.
ScalarField variation_written_out(const Mesh& mesh, const NvOptions& options) {
  const Normals normals = mesh_normals(mesh);
  const double radius = grown_support_radius(mesh.vertices, options.radius).radius;
  ScalarField variation;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    double dots = 0, count = 0;
    for (std::size_t j = 0; j < normals.size(); ++j)
      if (i != j && (mesh.vertices[i] - mesh.vertices[j]).norm() <= radius) {
        dots += normals[i].dot(normals[j]);
        ++count;
      }
    variation.push_back(count > 0 ? 1 - dots / count : 0);
  }
  return variation;
}

TEST(Nv, EqualsTheFormulaWrittenOut) {
  const Mesh mesh = shapes::bumpy_sphere(3);
  for (const double radius : {0.02, 0.3, 3.0})
    EXPECT_THAT(nv(mesh, {.radius = radius}),
                Pointwise(DoubleNear(1e-12), variation_written_out(mesh, {.radius = radius})));
}

TEST(Nv, OfAPlaneIsZero) { EXPECT_THAT(nv(shapes::grid(20)), Each(0)); }

TEST(Nv, OfTwoPointsIsOneMinusTheCosineBetweenTheirNormals) {
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}};
  EXPECT_THAT(nv_saliency(points, {Vec3::UnitZ(), Vec3::UnitX()}, {}), ElementsAre(1, 1));
  EXPECT_THAT(nv_saliency(points, {Vec3::UnitZ(), -Vec3::UnitZ()}, {}), ElementsAre(2, 2));
}

TEST(Nv, OfAPointOutOfReachIsZero) {
  std::vector<Vec3> points;
  Normals normals;
  for (int i = 0; i < 40; ++i) {
    points.emplace_back(i * 1e-3, 0, 0);
    normals.push_back(i % 2 == 0 ? Vec3::UnitZ() : Vec3::UnitX());
  }
  points.emplace_back(100, 0, 0);
  normals.push_back(Vec3::UnitY());
  const ScalarField variation = nv_saliency(points, normals, {});
  EXPECT_EQ(variation.back(), 0);
  EXPECT_GT(variation.front(), 0.4);
}

TEST(Nv, RefusesARadiusOfZero) { EXPECT_EQ(wrong_field(NvOptions{.radius = 0}), "radius"); }

TEST(NvDegenerate, WhatHasNoExtentOrIsNotFinite) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto of = [](const std::vector<Vec3>& points) {
    return nv_saliency(points, Normals(points.size(), Vec3::UnitZ()), {});
  };
  EXPECT_THROW(of({}), InputError);
  EXPECT_THROW(of(std::vector<Vec3>(5, Vec3(1, 2, 3))), InputError);
  EXPECT_THROW(of({{0, 0, 0}, {1, kNan, 0}}), InputError);
  EXPECT_THROW(of({{0, 0, 0}, {1e200, 0, 0}}), InputError);
}

}  // namespace
}  // namespace salbench
