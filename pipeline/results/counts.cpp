// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/counts.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include <fmt/format.h>

#include "pipeline/rules/values.h"

namespace salbench {
namespace {

using Time = MapCount::Time;

std::size_t& tally(StageCount& count, const Decision& decision) {
  if (decision.known()) return count.cached;
  if (decision.open()) return decision.waits() ? count.wait : count.compute;
  return decision.state == State::failed ? count.failed : count.not_applicable;
}

// nullopt if the file is gone.
std::optional<Time> written_at(const std::filesystem::path& file) {
  std::error_code gone;
  const auto time = std::filesystem::last_write_time(file, gone);
  if (gone) return {};
  return std::chrono::time_point_cast<Time::duration>(std::chrono::file_clock::to_sys(time));
}

std::string words_of(Reason reason) {
  switch (reason) {
    case Reason::none:
      return "";
    case Reason::never_computed:
      return "not in the cache";
    case Reason::changed:
      return "options, inputs, seed or version changed";
    case Reason::input_pending:
      return "waits for";
    case Reason::input_failed:
      return "failed input:";
    case Reason::no_files:
      return "no ground truth";
    case Reason::not_given:
      return "not given";
    case Reason::unreadable:
      return "a source file cannot be read";
    case Reason::damaged:
      return "damaged";
    case Reason::inapplicable:
      return "does not apply";
    case Reason::only_cached:
      return "not asked for";
    case Reason::needs_all:
      return "needs the mean over all shards";
  }
  return "";
}

}  // namespace

std::vector<std::vector<std::size_t>> rules_by_stage(const Rules& rules) {
  std::vector<std::vector<std::size_t>> stages;
  std::map<std::string_view, std::size_t> place;
  for (std::size_t rule = 0; rule < rules.size(); ++rule) {
    const auto [known, is_new] = place.emplace(rules[rule].stage, stages.size());
    if (is_new) stages.emplace_back();
    stages[known->second].push_back(rule);
  }
  return stages;
}

std::string state_of(const Decision& decision) {
  if (decision.known()) return "cached";
  if (!decision.open()) return decision.state == State::failed ? "failed" : "not applicable";
  return decision.waits() ? "waiting" : "to compute";
}

std::string why_of(const Project& project, const Plan& plan, const Job& job) {
  const Decision& decision = plan[job];
  std::string words = words_of(decision.reason);
  if (decision.reason == Reason::input_pending || decision.reason == Reason::input_failed)
    words += " " + project.rules[project.rule(job).inputs[decision.blocking_input]].stage;
  return words;
}

std::vector<StageCount> count_by_stage(const Project& project, const Plan& plan, Counted counted) {
  std::vector<StageCount> counts;
  for (const std::vector<std::size_t>& rules : rules_by_stage(project.rules)) {
    const Rule& first = project.rules[rules[0]];
    StageCount& count = counts.emplace_back(StageCount{.stage = first.stage, .version = first.version});
    std::map<std::string, std::size_t> reasons;
    for (const std::size_t rule : rules)
      for (const Job& job : project.jobs_of_rule(rule)) {
        ++tally(count, plan[job]);
        if (counted == Counted::open ? !plan[job].known() : plan[job].computed())
          if (std::string reason = why_of(project, plan, job); !reason.empty()) ++reasons[std::move(reason)];
      }
    count.reasons.assign(reasons.begin(), reasons.end());
    std::ranges::stable_sort(count.reasons, std::greater(), &std::pair<std::string, std::size_t>::second);
  }
  return counts;
}

std::vector<MapCount> count_maps(const Resolver& resolver, const FolderStore& store) {
  const Project& project = resolver.project();
  std::vector<MapCount> counts;
  std::unordered_map<std::string, std::optional<Time>> times;  // by file, which holds many maps of a family
  for (const std::vector<std::size_t>& rules : rules_by_stage(project.rules)) {
    if (!has_role(project.rules[rules[0]], Role::map)) continue;
    MapCount& count = counts.emplace_back(MapCount{.model = project.rules[rules[0]].subject});
    // Equal shapes, such as views of one, share a map: what the run computed for one of them counts once.
    std::vector<Digest> found;
    std::unordered_set<Digest> computed;
    for (const std::size_t rule : rules)
      for (const Job& job : project.jobs_of_rule(rule)) {
        const Decision& decision = resolver.plan()[job];
        if (decision.computed())
          computed.insert(decision.key);
        else if (decision.known())
          found.push_back(decision.key);
      }
    count.computed = computed.size();
    for (const Digest& key : found) {
      if (computed.contains(key)) continue;
      ++count.read;
      const auto file = store.file_of(key);
      if (!file) continue;
      const auto [time, is_new] = times.try_emplace(file->native());
      if (is_new) time->second = written_at(*file);
      count.first = std::min(count.first, time->second.value_or(count.first));
      count.last = std::max(count.last, time->second.value_or(count.last));
    }
  }
  return counts;
}

}  // namespace salbench
