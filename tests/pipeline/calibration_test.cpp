// SPDX-License-Identifier: GPL-3.0-or-later
// Intervals hold and tests err as often as they say, in a few hundred simulated data sets of equal models.
// scripts/calibrate does the same over thousands, with the variances of a run.
#include "tests/quality/calibration.h"

#include <cmath>

#include <gtest/gtest.h>

namespace salbench {
namespace {

constexpr std::size_t kDataSets = 400;

// Four standard errors of a rate over the data sets, as if each had one case.
double allowance(double rate) { return 4 * std::sqrt(rate * (1 - rate) / kDataSets); }

TEST(Calibration, IntervalsHoldAndTestsErrAsOftenAsTheySay) {
  const ScoreModel model{.mesh = .06,
                         .view = .03,
                         .model_of_mesh = .025,
                         .model_of_view = .035,
                         .models = 4,
                         .meshes = 25,
                         .views = 6};
  std::size_t honest = 0;
  for (const Rate& rate : calibrate(model, kDataSets, 1)) {
    if (rate.what == "unit shape: interval of a difference") {
      EXPECT_LT(rate.value(), rate.expected - allowance(rate.expected)) << "views pass for meshes";
    } else if (!rate.what.starts_with("unit shape")) {
      ++honest;
      EXPECT_NEAR(rate.value(), rate.expected, allowance(rate.expected)) << rate.what;
    }
  }
  EXPECT_EQ(honest, 10U);
}

}  // namespace
}  // namespace salbench
