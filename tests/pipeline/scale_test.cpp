// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/inputs/loading.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

// Cube with this diagonal, shifted along x.
std::string of_cube(double diagonal, double x = 0) {
  const double side = diagonal / std::sqrt(3.0);
  return odd_scale(std::vector<Vec3>{Vec3(x, 0, 0), Vec3(x + side, side, side)});
}

TEST(OddScale, IsNoneOfWhatIsUsual) {
  EXPECT_EQ(odd_scale(shapes::sphere(2).vertices), "");
  EXPECT_EQ(odd_scale({}), "");
  for (const double diagonal : {1.1e-3, 1.0, 1800.0, 0.9e6}) {
    EXPECT_EQ(of_cube(diagonal), "") << diagonal;
    EXPECT_EQ(of_cube(diagonal, 900 * diagonal), "") << diagonal;
    EXPECT_EQ(of_cube(diagonal, -900 * diagonal), "") << diagonal;
  }
}

TEST(OddScale, NamesAnUnusualUnit) {
  EXPECT_EQ(of_cube(0.9e-3), "the bounding box has a diagonal of 0.0009: check the unit of length");
  EXPECT_EQ(of_cube(1.1e6), "the bounding box has a diagonal of 1.1e+06: check the unit of length");
}

TEST(OddScale, NamesWhatAnOffsetCosts) {
  for (const double away : {1.0, -1.0})
    EXPECT_EQ(
        of_cube(2, away * 1e5),
        "coordinates reach 5e+04 diagonals of the bounding box from the origin: single precision has 336 "
        "steps across the shape");
  EXPECT_THAT(of_cube(1e-4, 1e7), AllOf(HasSubstr("diagonal of 0.0001: check the unit of length; "),
                                        HasSubstr("coordinates reach 1e+11 diagonals")));
}

}  // namespace
}  // namespace salbench
