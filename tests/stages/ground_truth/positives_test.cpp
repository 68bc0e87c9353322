// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/ground_truth/positives.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/types.h"

namespace salbench {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kUnseen = std::numeric_limits<double>::quiet_NaN();

TEST(PointsOnTop, AreThatPartOfThePoints) {
  const ScalarField density = {5, 1, 9, 3, 7, 2, 8, 4, 6, 0};
  EXPECT_THAT(points_on_top(density, 20), ElementsAre(2, 6));
  EXPECT_THAT(points_on_top(density, 21), ElementsAre(2, 4, 6)) << "less than 21 % lie above each";
  EXPECT_THAT(points_on_top(density, 1), ElementsAre(2));
  EXPECT_THAT(points_on_top(density, 99.9), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8)) << "never the minimum";
}

TEST(PointsOnTop, OfEqualValuesAreAllOrNone) {
  const ScalarField density = {1, 3, 2, 2, 2, 0, 0, 0, 0, 0};
  EXPECT_THAT(points_on_top(density, 10), ElementsAre(1));
  EXPECT_THAT(points_on_top(density, 20), ElementsAre(1, 2, 3, 4)) << "all that tie at the border";
  EXPECT_THAT(points_on_top(density, 40), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(points_on_top(density, 90), ElementsAre(0, 1, 2, 3, 4));
}

TEST(PointsAboveMean, AreThoseStrictlyAbove) {
  EXPECT_THAT(points_above_mean(ScalarField{1, 2, 3, 6}), ElementsAre(3));
  EXPECT_THAT(points_above_mean(ScalarField{0, 0, 0, 4, 1}), ElementsAre(3));
  constexpr double kHuge = 1.7e308;
  EXPECT_THAT(points_above_mean(ScalarField{kHuge, kHuge, -kHuge, kHuge}), ElementsAre(0, 1, 3));
}

TEST(Positives, NeitherCountNorAreWhatWasNotSeen) {
  const ScalarField density = {kUnseen, 1, 4, kUnseen, 2, 3, 0, kUnseen};
  EXPECT_THAT(points_on_top(density, 20), ElementsAre(2));
  EXPECT_THAT(points_above_mean(density), ElementsAre(2, 5));
}

TEST(Positives, OfAConstantDensityAreNone) {
  for (const ScalarField& density :
       {ScalarField{0.1, 0.1, 0.1}, ScalarField{5, kUnseen}, ScalarField{kUnseen}, ScalarField{}}) {
    EXPECT_THAT(points_on_top(density, 50), IsEmpty());
    EXPECT_THAT(points_above_mean(density), IsEmpty());
  }
}

}  // namespace
}  // namespace salbench
