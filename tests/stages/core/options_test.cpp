// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/options.h"

#include "tests/support/test.h"

namespace salbench {
namespace {

struct Sample {
  std::int32_t count = 3;
  double radius = 0.5;
  double offset = 0;
  bool flag = false;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("count", self.count, {"how many", "points", at_least(1)});
    visit("radius", self.radius, {"how far", "R", above_and_up_to(0, 1)});
    visit("offset", self.offset, {"any number"});
    visit("flag", self.flag, {"a switch"});
  }
};

TEST(Range, KnowsItsBounds) {
  EXPECT_TRUE(at_least(1).contains(1) && at_least(1).contains(1e300));
  EXPECT_FALSE(at_least(1).contains(0.999));
  EXPECT_FALSE(above(0).contains(0));
  EXPECT_TRUE(above(0).contains(std::numeric_limits<double>::denorm_min()));
  EXPECT_TRUE(between(-1, 1).contains(-1) && between(-1, 1).contains(1));
  EXPECT_FALSE(between(-1, 1).contains(-1.5) || between(-1, 1).contains(1.5));
  EXPECT_FALSE(above_and_up_to(0, 1).contains(0));
  EXPECT_TRUE(above_and_up_to(0, 1).contains(1));
  EXPECT_TRUE(Range{}.contains(-1e300));
}

TEST(Range, HoldsNothingThatIsNotFinite) {
  for (const Range& range : {Range{}, at_least(0), above(0), between(0, 1)})
    for (const double value : {kInfinity, -kInfinity, std::nan("")}) EXPECT_FALSE(range.contains(value));
}

TEST(Range, ReadsAsAnInequality) {
  EXPECT_EQ(at_least(1).text(), ">= 1");
  EXPECT_EQ(above(0).text(), "> 0");
  EXPECT_EQ(between(0.01, 10).text(), "0.01 <= x <= 10");
  EXPECT_EQ(above_and_up_to(0, 1).text(), "0 < x <= 1");
  EXPECT_EQ(Range{}.text(), "");
}

TEST(OptionsCheck, RefusesTheFirstFieldOutsideItsRange) {
  for (const Sample& right : {Sample{}, Sample{.offset = -1e300}}) EXPECT_NO_THROW(check(right));
  for (const auto& [wrong, said] :
       {std::pair(Sample{.count = 0, .radius = -1}, "count must be at least 1, not 0"),
        {Sample{.radius = -0.5}, "radius must be a number above 0 and at most 1, not -0.5"},
        {Sample{.radius = kNan}, "radius must be a finite number, not nan"},
        {Sample{.offset = kInfinity}, "offset must be a finite number, not inf"}})
    EXPECT_THAT([&wrong = wrong] { check(wrong); }, ThrowsMessage<OptionError>(said));
}

TEST(OptionsCheck, AcceptsNoOptions) { EXPECT_NO_THROW(check(NoOptions{})); }

}  // namespace
}  // namespace salbench
