// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/quantile.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace salbench {
namespace {

TEST(Quantile, IsLinearBetweenTheValues) {
  const std::vector<double> values = {40, std::nan(""), 10, 30, 20};
  EXPECT_DOUBLE_EQ(quantile(values, 0), 10);
  EXPECT_DOUBLE_EQ(quantile(values, 0.25), 17.5);
  EXPECT_DOUBLE_EQ(median(values), 25);
  EXPECT_DOUBLE_EQ(quantile(values, 0.9), 37);
  EXPECT_DOUBLE_EQ(quantile(values, 1), 40);
}

TEST(Quantile, OfOneValueOrNone) {
  EXPECT_DOUBLE_EQ(quantile(std::vector<double>{3}, 0.3), 3);
  EXPECT_TRUE(std::isnan(median(std::vector<double>{})));
  EXPECT_TRUE(std::isnan(median(std::vector<double>{std::nan("")})));
}

TEST(Quantile, TakesFractionsAndNoPercentages) {
  EXPECT_THROW(quantile(std::vector<double>{1, 2}, 95), std::logic_error);
  EXPECT_THROW(quantile(std::vector<double>{1, 2}, -0.1), std::logic_error);
}

}  // namespace
}  // namespace salbench
