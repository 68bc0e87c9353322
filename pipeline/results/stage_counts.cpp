// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/stage_counts.h"

#include <algorithm>
#include <map>

namespace salbench {
namespace {

std::size_t& tally(StageCount& count, const Decision& decision) {
  if (decision.known()) return count.cached;
  if (decision.open()) return decision.waits() ? count.wait : count.compute;
  return decision.state == State::failed ? count.failed : count.not_applicable;
}

}  // namespace

std::vector<StageCount> count_by_stage(const Project& project, const Plan& plan, const Why& why) {
  std::vector<StageCount> counts;
  std::map<std::string, std::size_t> place;                 // of a stage
  std::vector<std::map<std::string, std::size_t>> reasons;  // [stage]
  for (const Rule& rule : project.rules)
    if (place.emplace(rule.stage, counts.size()).second)
      counts.push_back({.stage = rule.stage, .version = rule.version, .reasons = {}});
  reasons.resize(counts.size());
  for (const Job& job : project.jobs()) {
    const std::size_t stage = place[project.rule(job).stage];
    ++tally(counts[stage], plan[job]);
    if (const std::string reason = why ? why(job) : ""; !reason.empty()) ++reasons[stage][reason];
  }
  for (std::size_t stage = 0; stage < counts.size(); ++stage) {
    counts[stage].reasons.assign(reasons[stage].begin(), reasons[stage].end());
    std::ranges::stable_sort(counts[stage].reasons, std::greater(),
                             &std::pair<std::string, std::size_t>::second);
  }
  return counts;
}

}  // namespace salbench
