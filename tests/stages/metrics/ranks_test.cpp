// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/ranks.h"

#include "stages/core/rng.h"
#include "stages/metrics/roc.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(Order, AscendsAndKeepsTheIndicesOfEqualValues) {
  Rng rng(1, "order", "");
  for (const double scale : {1e-300, 1e-9, 1.0, 1e300}) {
    ScalarField field(3000);
    for (double& v : field)
      v = (rng.below(3) == 0 ? std::floor(rng.uniform() * 4) : rng.uniform() - 0.5) * scale;
    field[7] = -0.0;
    field[9] = 0.0;
    Order expected(field.size());
    for (std::uint32_t i = 0; i < expected.size(); ++i) expected[i] = i;
    std::ranges::stable_sort(expected, {}, [&](std::uint32_t i) { return field[i]; });
    EXPECT_EQ(ascending_order(field), expected) << scale;
  }
  EXPECT_TRUE(ascending_order({}).empty());
}

// NaN differs from itself: loops over equal values must still end.
TEST(Order, RefusesNanAndRanksEndWhateverThereIs) {
  const double nan = std::nan("");
  for (const ScalarField& field : {ScalarField{nan}, {nan, 1, 2}, {1, 2, nan, 2}, {nan, nan}})
    EXPECT_THROW(ascending_order(field), std::logic_error);
  const ScalarField field = {1, nan, 2, nan}, ones(4, 1);
  const Order order = {0, 2, 1, 3};
  EXPECT_EQ(mid_ranks(field, order, ones).below, (ScalarField{0.5, 2.5, 1.5, 3.5}));
  EXPECT_EQ(upper_fifth(field, order), (ScalarField{0, 0, 0, 1}));
  EXPECT_TRUE(std::isfinite(auc_judd(field, order, ScalarField{0, 1, 0, 0})));
}

TEST(MidRanks, AreTheWeightBelowAndHalfOfThatAtEachValue) {
  const ScalarField field = {2, 1, 2, 5};
  const Order order = ascending_order(field);
  EXPECT_EQ(mid_ranks(field, order, ScalarField(4, 1)).below, (ScalarField{2, 0.5, 2, 3.5}));
  const MidRanks weighed = mid_ranks(field, order, ScalarField{1, 4, 2, 3});
  EXPECT_EQ(weighed.below, (ScalarField{5.5, 2, 5.5, 8.5}));
  EXPECT_EQ(weighed.total, 10);
}

TEST(UpperFifth, HasAllOfEqualValuesOrNoneAndNothingAtTheMinimum) {
  const auto top = [](const ScalarField& field) { return upper_fifth(field, ascending_order(field)); };
  EXPECT_EQ(top({1, 2, 3, 4, 5}), (ScalarField{0, 0, 0, 0, 1}));
  EXPECT_EQ(top({1, 2, 3, 4, 5, 6}), (ScalarField{0, 0, 0, 0, 1, 1})) << "less than a fifth is higher";
  EXPECT_EQ(top({1, 2, 5, 5, 5}), (ScalarField{0, 0, 1, 1, 1}));
  EXPECT_EQ(top({0, 0, 0, 0, 0, 0, 0, 0, 0, 3}), (ScalarField{0, 0, 0, 0, 0, 0, 0, 0, 0, 1}));
  EXPECT_EQ(top({2, 2, 2}), ScalarField(3, 0));
}

}  // namespace
}  // namespace salbench
