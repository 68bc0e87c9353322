// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stats/distance.h"

#include <cmath>

#include <gtest/gtest.h>

namespace salbench {
namespace {

Histogram spike(std::size_t bin, double height = 100) {
  Histogram h{};
  h[bin] = height;
  return h;
}

Histogram flat() {
  Histogram h{};
  h.fill(1);
  return h;
}

TEST(KolmogorovSmirnov, SpikeAgainstFlatIsTheLargerSide) {
  // Below bin 30 the flat one has .3, up to and with it the spike has 1 against .31.
  EXPECT_NEAR(kolmogorov_smirnov(spike(30), flat()), 0.69, 1e-12);
  EXPECT_NEAR(kolmogorov_smirnov(flat(), spike(80)), 0.8, 1e-12);
}

TEST(KolmogorovSmirnov, SeparateSpikesAreOneApart) {
  EXPECT_EQ(kolmogorov_smirnov(spike(3), spike(99)), 1);
  EXPECT_EQ(kolmogorov_smirnov(spike(3), spike(3)), 0);
}

TEST(KolmogorovSmirnov, DoesNotSeeTheTotal) {
  Histogram counts = spike(10, 3);
  counts[20] = 1;
  Histogram density = spike(10, 75);
  density[20] = 25;
  EXPECT_EQ(kolmogorov_smirnov(counts, density), 0);
  EXPECT_NEAR(kolmogorov_smirnov(counts, spike(20)), 0.75, 1e-15);
}

TEST(KolmogorovSmirnov, OfAnEmptyHistogramIsUndefined) {
  EXPECT_TRUE(std::isnan(kolmogorov_smirnov(Histogram{}, flat())));
  EXPECT_TRUE(std::isnan(kolmogorov_smirnov(flat(), Histogram{})));
}

}  // namespace
}  // namespace salbench
