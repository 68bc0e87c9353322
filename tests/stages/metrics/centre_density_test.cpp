// SPDX-License-Identifier: GPL-3.0-or-later
// Densities of marks on the other shapes of a set, used as negatives by sauc.

#include "stages/geometry/centre.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(CentreDensity, OfTheOthersLeavesThisShapeOut) {
  const std::vector<Vec3> points = {{1, 0, 0}, {-1, 0, 0}, {0, 0.5, 0}, {0, -0.5, 0}};
  const GroundTruth outside{{3, 1, 0, 0}, {}}, even{{1, 1, 1, 1}, {}}, picked{{}, {{2}, {2, 0}}};
  const CentreDensity first = centre_density(points, outside), second = centre_density(points, even),
                      third = centre_density(points, picked);
  EXPECT_EQ(first.marked[99], 1);
  EXPECT_EQ(first.points[99], 0.5);
  EXPECT_EQ(third.marked[50], 2.0 / 3);
  CentreDensity set;
  for (const CentreDensity* shape : {&first, &second, &third}) add(set, *shape);
  const ScalarField of_others = density_of_others(points, first, set);
  EXPECT_NEAR(of_others[0], (0.5 + 1.0 / 3) / 1, 1e-15);
  EXPECT_NEAR(of_others[2], (0.5 + 2.0 / 3) / 1, 1e-15);
  EXPECT_EQ(of_others[1], of_others[0]);
  CentreDensity alone;
  add(alone, first);
  EXPECT_TRUE(density_of_others(points, first, alone).empty());
}

TEST(CentreDensity, IsZeroWhereNoOtherShapeHasPoints) {
  const std::vector<Vec3> square = {{1, 0, 0}, {-1, 0, 0}, {0, 0.5, 0}, {0, -0.5, 0}},
                          ring = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  const CentreDensity own = centre_density(square, {{1, 1, 1, 1}, {}}),
                      other = centre_density(ring, {{1, 2, 3, 4}, {}});
  CentreDensity set;
  add(set, other);
  add(set, own);
  EXPECT_EQ(density_of_others(square, own, set), (ScalarField{1, 1, 0, 0}));
}

TEST(CentreDensity, SaysNothingWhereTheGroundTruthDoesNot) {
  const std::vector<Vec3> points = {{1, 0, 0}, {-1, 0, 0}, {0, 0.5, 0}};
  const double unseen = std::nan(""), infinity = kInfinity;
  for (const ScalarField& saliency : {ScalarField{0, 0, 0}, ScalarField{1, -1, 2},
                                      ScalarField{1, infinity, 2}, ScalarField{unseen, unseen, unseen}})
    EXPECT_EQ(centre_density(points, {saliency, {}}).shapes, 0);
  EXPECT_EQ(centre_density(points, {{}, {{}}}).shapes, 0);
  EXPECT_EQ(centre_density(points, {{}, {{3, -1}}}).shapes, 0) << "no points of this shape";
  const CentreDensity masked = centre_density(points, {{unseen, 1, 3}, {}});
  EXPECT_EQ(masked.points[masked.points.size() - 1] + masked.points[0] + masked.points[50],
            masked.shapes == 1 ? 0.5 : -1);
  EXPECT_THROW(centre_density(points, {{1, 2}, {}}), InputError);
  EXPECT_THROW(centre_density(std::vector<Vec3>(3, Vec3(1, 1, 1)), {{1, 2, 3}, {}}), InputError);
}

}  // namespace
}  // namespace salbench
