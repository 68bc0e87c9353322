// SPDX-License-Identifier: GPL-3.0-or-later
// timeline.csv: when which node of the graph was at work.
#pragma once

#include <vector>

#include "io/table.h"
#include "pipeline/engine/resolver.h"

namespace salbench {

inline constexpr std::size_t kTimelineIntervals = 240;

// start, end (s since the run began), node ("fpfh of scans"), busy (core-seconds that the node computed
// within the interval): the run in kTimelineIntervals equal intervals, rows where a node was at work.
// `records` are those of the rules: [rule].
Table timeline_table(const Rules& rules, const std::vector<RuleRecord>& records, Clock::time_point began,
                     double seconds);

}  // namespace salbench
