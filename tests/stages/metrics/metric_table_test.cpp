// SPDX-License-Identifier: GPL-3.0-or-later
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "stages/metrics/metrics.h"

namespace salbench {
namespace {

TEST(MetricTable, LowerIsBetterForDistancesAlone) {
  std::vector<std::string> lower;
  for (const Metric& metric : metric_table())
    if (!metric.higher_is_better) lower.push_back(metric.name);
  EXPECT_EQ(lower, (std::vector<std::string>{"kl", "kl_smoothed", "mse", "mae", "kl_area", "kl_smoothed_area",
                                             "mse_area", "mae_area"}));
}

TEST(ChosenMetrics, ComeInTheOrderOfTheTable) {
  MetricsOptions options;
  options.names = {"kl", "nss", "auc_judd_area"};
  std::vector<std::string> names;
  for (const Metric& metric : chosen_metrics(options)) names.push_back(metric.name);
  EXPECT_EQ(names, (std::vector<std::string>{"nss", "kl", "auc_judd_area"}));
  EXPECT_TRUE(any_by_area(chosen_metrics(options)));
  EXPECT_FALSE(any_by_area(chosen_metrics({})));
  options.names = {"nss", "no_such"};
  EXPECT_THROW(chosen_metrics(options), OptionError);
}

}  // namespace
}  // namespace salbench
