// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/results/record.h"

namespace salbench {
namespace {

using Busy = std::array<double, kTimelineIntervals>;  // core-seconds

Busy busy_of(const RuleRecord& record, Clock::time_point began, double interval) {
  Busy busy{};
  for (std::size_t job = 0; job < record.seconds.size(); ++job) {
    const double begin = std::chrono::duration<double>(record.started[job] - began).count();
    const double end = begin + static_cast<double>(record.seconds[job]);
    const auto first = static_cast<std::size_t>(std::max(0.0, begin / interval));
    for (std::size_t i = first; i < busy.size() && static_cast<double>(i) * interval < end; ++i) {
      const double from = std::max(begin, static_cast<double>(i) * interval);
      const double to = std::min(end, static_cast<double>(i + 1) * interval);
      busy[i] += std::max(0.0, to - from);
    }
  }
  return busy;
}

double microseconds(double seconds) { return std::round(seconds * 1e6) / 1e6; }

}  // namespace

Table timeline_table(const Rules& rules, const std::vector<RuleRecord>& records, Clock::time_point began,
                     double seconds) {
  Table table{.columns = {"start", "end", "node", "busy"}, .rows = {}};
  const double interval = seconds / static_cast<double>(kTimelineIntervals);
  if (!(interval > 0)) return table;
  std::vector<Busy> busy;
  for (const RuleRecord& record : records) busy.push_back(busy_of(record, began, interval));
  for (std::size_t i = 0; i < kTimelineIntervals; ++i)
    for (std::size_t rule = 0; rule < busy.size(); ++rule)
      if (const double at_work = microseconds(busy[rule][i]); at_work > 0)
        table.rows.push_back({microseconds(static_cast<double>(i) * interval),
                              microseconds(static_cast<double>(i + 1) * interval), node_name(rules[rule]),
                              at_work});
  return table;
}

}  // namespace salbench
