// SPDX-License-Identifier: GPL-3.0-or-later
// Scores of maps that were smoothed, beside those of the maps as they are, which all other tables have.
#pragma once

#include <string>
#include <vector>

#include "pipeline/results/results.h"
#include "stages/stats/unit.h"

namespace salbench {

struct SmoothedRows {
  std::string steps;  // of smoothing, or "best"
  std::vector<ResultRow> rows;
};

inline constexpr const char* kBestSteps = "best";

// The scores for each number of steps, then for each shape, model and metric the best of them: the ground
// truth itself chose it, so it is an upper bound and no score. None where the run smooths no maps.
std::vector<SmoothedRows> smoothed_rows(const RunState& run, const Metrics& metrics);

// Means over units with Student's intervals, whose columns are those of docs/data_dictionary.md.
Table smoothing_table(const std::vector<SmoothedRows>& smoothed, const Metrics& metrics, Observation unit);

}  // namespace salbench
