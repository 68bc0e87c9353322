// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stats/multiple.h"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace salbench {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::NanSensitiveDoubleEq;
using Sample = std::vector<double>;

TEST(HolmAdjusted, FourTestsByHand) {
  // Sorted .005 .01 .03 .04, times 4 3 2 1: .02 .03 .06 and .04, which may not fall below .06 again.
  EXPECT_THAT(holm_adjusted(Sample{0.01, 0.04, 0.03, 0.005}),
              ElementsAre(DoubleEq(0.03), DoubleEq(0.06), DoubleEq(0.06), DoubleEq(0.02)));
}

TEST(HolmAdjusted, NeverExceedsOne) {
  EXPECT_THAT(holm_adjusted(Sample{0.9, 0.4, 0.5}), ElementsAre(1, 1, 1));
}

TEST(HolmAdjusted, UndefinedTestsDoNotCount) {
  EXPECT_THAT(holm_adjusted(Sample{std::nan(""), 0.01, 0.02}),
              ElementsAre(NanSensitiveDoubleEq(std::nan("")), DoubleEq(0.02), DoubleEq(0.02)));
}

TEST(HolmAdjusted, OneTestStaysAsItIs) {
  EXPECT_THAT(holm_adjusted(Sample{0.03}), ElementsAre(0.03));
  EXPECT_THAT(holm_adjusted(Sample{}), IsEmpty());
}

}  // namespace
}  // namespace salbench
