// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/mc.h"

#include <algorithm>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "tests/stages/models/surfaces.h"

namespace salbench {
namespace {

using testing::DoubleNear;
using testing::Each;
using testing::Pointwise;

ScalarField mc(const Mesh& mesh, const McOptions& options = {}) {
  return mc_saliency(mesh.vertices, mesh.faces, options);
}

TEST(Mc, OfASphereOfAnySizeIsOne) {  // the radius is the unit
  EXPECT_THAT(mc(shapes::moved(shapes::sphere(4), 40)), Each(DoubleNear(1, 0.03)));
}

TEST(Mc, IsAMagnitude) {
  Mesh inside_out = shapes::bumpy_sphere(3);
  for (Triangle& face : inside_out.faces) std::swap(face[0], face[1]);
  EXPECT_THAT(mc(inside_out), Pointwise(DoubleNear(1e-9), mc(shapes::bumpy_sphere(3))));
}

TEST(Mc, TaubinsCurvatureIsAnOption) {
  const ScalarField saliency = mc(shapes::bumpy_sphere(3), {.curvature = CurvatureMethod::taubin});
  EXPECT_NE(saliency, mc(shapes::bumpy_sphere(3)));
}

TEST(McDegenerate, NoFaces) { EXPECT_THAT(mc({shapes::random_cloud(30, 1), {}}), Each(0)); }

TEST(McDegenerate, WhatHasNoExtentOrIsNotFinite) {
  EXPECT_THROW(mc({}), InputError);
  EXPECT_THROW(mc({{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}, {{0, 1, 2}}}), InputError);
  Mesh mesh = shapes::sphere(2);
  mesh.vertices[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(mc(mesh), InputError);
}

}  // namespace
}  // namespace salbench
