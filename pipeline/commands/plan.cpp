// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "io/table.h"
#include "pipeline/commands/report.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/commands/why.h"
#include "pipeline/results/stage_counts.h"

namespace salbench {
namespace {

struct PlanReport {
  std::vector<StageCount> stages;
  std::size_t open = 0;  // jobs to compute or waiting
};

Json reason_json(const std::pair<std::string, std::size_t>& reason) {
  return {{"why", reason.first}, {"jobs", reason.second}};
}

Json json_of(const PlanReport& report) {
  return {{"stages",
           list_of(report.stages,
                   [](const StageCount& count) {
                     return Json{{"stage", count.stage},   {"version", count.version},
                                 {"cached", count.cached}, {"to_compute", count.compute},
                                 {"waiting", count.wait},  {"not_applicable", count.not_applicable},
                                 {"failed", count.failed}, {"reasons", list_of(count.reasons, reason_json)}};
                   })},
          {"open", report.open}};
}

PlanReport plan_of(const Setup& setup) {
  const FolderStore store(setup.cache, Access::read_only);
  const Plan plan = make_plan(setup.project, store);
  Causes causes(setup.project, plan, setup.cache, kOpenedForCounting);
  PlanReport report{.stages = count_by_stage(setup.project, plan, why_open(causes))};
  for (const StageCount& count : report.stages) report.open += count.compute + count.wait;
  return report;
}

std::string text_of(const PlanReport& report) {
  Table table{.columns = {"stage", "cached", "to compute", "waiting", "not applicable", "failed", "why"},
              .rows = {}};
  for (const StageCount& count : report.stages) {
    std::string reasons;
    for (const auto& [reason, n] : count.reasons)
      reasons += fmt::format("{}{}: {}", reasons.empty() ? "" : "; ", reason, n);
    table.rows.push_back({count.stage, cell_of(count.cached), cell_of(count.compute), cell_of(count.wait),
                          cell_of(count.not_applicable), cell_of(count.failed), reasons});
  }
  return fmt::format("{}\n{} jobs to do{}\n", aligned(table), report.open,
                     report.open > 0 ? "; a waiting job is skipped if its input turns out unchanged" : "");
}

ExitStatus print_plan(const Arguments& arguments, ReportFormat format) {
  const PlanReport report = plan_of(Setup(arguments));
  print_report(format, "plan", json_of(report), text_of(report));
  return kAllDone;
}

}  // namespace

Subcommand plan_subcommand(Arguments& arguments) {
  const FormatWord format = default_format();
  return {
      "plan", "count what a run would compute, and why; changes nothing",
      planning_parameters(arguments, {shard_parameter(arguments), format_parameter(format)}),
      [&arguments, format](const std::atomic<bool>&) { return print_plan(arguments, format_of(format)); }};
}

}  // namespace salbench
