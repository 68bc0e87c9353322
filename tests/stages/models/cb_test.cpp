// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/cb.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "tests/stages/models/surfaces.h"

namespace salbench {
namespace {

using testing::DoubleNear;
using testing::Each;
using testing::ElementsAre;

TEST(Cb, IsTheDistanceFromTheCentroidInUnitsOfTheLargest) {
  EXPECT_THAT(cb_saliency(std::vector<Vec3>{{3, 0, 0}, {-1, 0, 0}, {-2, 0, 0}}, {}),
              ElementsAre(1, DoubleNear(1.0 / 3, 1e-15), DoubleNear(2.0 / 3, 1e-15)));
}

TEST(Cb, IsUniformOnASphere) {
  EXPECT_THAT(cb_saliency(shapes::moved(shapes::sphere(3), 9).vertices, {}), Each(DoubleNear(1, 1e-9)));
}

TEST(CbDegenerate, WhatHasNoExtentOrIsNotFinite) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(cb_saliency({}, {}), InputError);
  EXPECT_THROW(cb_saliency(std::vector<Vec3>(5, Vec3(1, 2, 3)), {}), InputError);
  EXPECT_THROW(cb_saliency(std::vector<Vec3>{{0, 0, 0}, {1, kNan, 0}}, {}), InputError);
  EXPECT_THROW(cb_saliency(std::vector<Vec3>{{0, 0, 0}, {1e200, 0, 0}}, {}), InputError);
}

}  // namespace
}  // namespace salbench
