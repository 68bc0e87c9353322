// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/options.h"

#include "stages/core/errors.h"
#include "stages/core/number.h"

namespace salbench {

void check(const MetricsOptions& options) {
  check_ranges(options);
  smoothing_steps(options);
}

std::vector<std::int32_t> smoothing_steps(const MetricsOptions& options) {
  constexpr std::int32_t kMostSteps = 100000;
  std::vector<std::int32_t> steps;
  for (const std::string& word : options.smoothing) {
    steps.push_back(number_in<std::int32_t>(word).value_or(-1));
    if (steps.back() < 0 || steps.back() > kMostSteps)
      throw OptionError("smoothing",
                        "has '" + word + "', not a number of steps from 0 to " + std::to_string(kMostSteps));
    if (steps.size() > 1 && steps.back() <= steps.end()[-2])
      throw OptionError("smoothing", "has " + word + " after " + std::to_string(steps.end()[-2]) +
                                         ": expected ascending numbers of steps");
  }
  return steps;
}

}  // namespace salbench
