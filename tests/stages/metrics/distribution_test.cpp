// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/distribution.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "stages/core/rng.h"
#include "stages/metrics/moments.h"
#include "stages/metrics/roc.h"

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

// A NaN is not equal to itself: loops over equal values must not wait for it to be.
TEST(Order, RefusesNanAndRanksEndWhateverThereIs) {
  const double nan = std::nan("");
  for (const ScalarField& field : {ScalarField{nan}, {nan, 1, 2}, {1, 2, nan, 2}, {nan, nan}})
    EXPECT_THROW(ascending_order(field), std::logic_error);
  const ScalarField field = {1, nan, 2, nan};
  const Order order = {0, 2, 1, 3};
  EXPECT_EQ(distribution(field, order, vertex_measure(4)).mid, (ScalarField{0.5, 2.5, 1.5, 3.5}));
  const Measure measure = vertex_measure(4);
  const ScalarField map = {1, 2, 3, 4};
  const Distribution of_map = distribution(map, ascending_order(map), measure);
  for (const int percent : {20, 10, 5, 1})
    EXPECT_TRUE(
        std::isfinite(top_score({map, of_map, moments(map, measure), field, order}, percent, measure).auc));
}

TEST(Distribution, CountsWeightBelowAndAtEachValue) {
  const ScalarField field = {2, 1, 2, 5};
  const Order order = ascending_order(field);
  EXPECT_EQ(distribution(field, order, vertex_measure(4)).mid, (ScalarField{2, 0.5, 2, 3.5}));
  const Distribution d = distribution(field, order, area_measure(ScalarField{1, 4, 2, 3}));
  EXPECT_EQ(d.mid, (ScalarField{5.5, 2, 5.5, 8.5}));
  EXPECT_EQ(d.weight_below(2), 4);
  EXPECT_EQ(d.weight_below(2.5), 7);
  EXPECT_EQ(d.weight_below(9), 10);
  EXPECT_EQ(d.quantile(0), 1);
  EXPECT_EQ(d.quantile(0.39), 1);
  EXPECT_EQ(d.quantile(0.41), 2);
  EXPECT_EQ(d.quantile(0.99), 5);
}

}  // namespace
}  // namespace salbench
