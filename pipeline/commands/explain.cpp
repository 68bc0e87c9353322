// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/explain.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "io/table.h"
#include "pipeline/commands/report.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/commands/why.h"
#include "pipeline/config/section.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

// A mesh may be called "52_3", as the scan 3 of the mesh 52 is: it goes first.
Unit require_unit(const Project& project, const std::string& name) {
  for (const Level level : {kMeshes, kClouds, kScans})
    for (const Unit unit : project.units.of(level))
      if (project.units.name(unit) == name && !project.jobs_of(unit).empty()) return unit;
  throw ConfigError(
      fmt::format("explain: there is no item '{}'; a shape is named like its file (52), the scans of a mesh "
                  "52_0 to 52_11",
                  name));
}

void require_stage(const Project& project, const std::vector<Job>& jobs, const ExplainOptions& options) {
  std::vector<std::string_view> known;
  for (const Job& job : jobs) known.push_back(project.rule(job).stage);
  if (options.stage.empty() || std::find(known.begin(), known.end(), options.stage) != known.end()) return;
  throw ConfigError(
      fmt::format("explain: {} has no stage '{}'; {}", options.item, options.stage,
                  did_you_mean(options.stage, known, fmt::format("it has {}", fmt::join(known, ", ")))));
}

std::string state_of(const Decision& job, const Cause& cause) {
  if (cause.reason == Reason::damaged) return "damaged";
  if (job.known()) return "cached";
  if (!job.open()) return "not applicable";
  return job.waits() ? "waiting" : "to compute";
}

}  // namespace

std::vector<Explanation> explain(const Project& project, const Index& index,
                                 const std::filesystem::path& cache, const ExplainOptions& options) {
  std::vector<Job> jobs = project.jobs_of(require_unit(project, options.item));
  require_stage(project, jobs, options);
  if (!options.stage.empty())
    std::erase_if(jobs, [&](const Job& job) { return project.rule(job).stage != options.stage; });
  const Plan plan = make_plan_of(project, index, jobs);
  Causes causes(project, plan, cache);
  std::vector<Explanation> explanations;
  for (const Job& job : jobs) {
    const Cause cause = causes.of(job, true);
    explanations.push_back(
        {project.rule(job).stage, state_of(plan[job], cause), why_line(causes, job, cause), cause.file});
  }
  return explanations;
}

namespace {

struct ExplainReport {
  ExplainOptions asked;
  std::vector<Explanation> stages;
};

Json json_of(const ExplainReport& report) {
  return {{"item", report.asked.item},
          {"stages", list_of(report.stages, [](const Explanation& stage) {
             return Json{{"stage", stage.stage},
                         {"state", stage.state},
                         {"why", stage.why},
                         {"file", stage.file.empty() ? std::nullopt : std::optional(stage.file)}};
           })}};
}

ExplainReport explained(const Setup& setup, const ExplainOptions& options) {
  const FolderStore store(setup.cache, Access::read_only);
  return {options, explain(setup.project, store, setup.cache, options)};
}

std::string text_of(const ExplainReport& report) {
  Table table{.columns = {"stage", report.asked.item, "why"}, .rows = {}};
  for (const Explanation& stage : report.stages) table.rows.push_back({stage.stage, stage.state, stage.why});
  const Explanation& first = report.stages.front();
  if (report.asked.stage.empty() || first.file.empty()) return aligned(table);
  return fmt::format("{}{}: {}\n", aligned(table), first.state == "to compute" ? "nearest" : "artefact",
                     first.file.string());
}

ExitStatus print_explanation(const Arguments& arguments, const ExplainOptions& options, ReportFormat format) {
  const ExplainReport report = explained(Setup(arguments, {}, Pictures::cached), options);
  print_report(format, "explain", json_of(report), text_of(report));
  return kAllDone;
}

}  // namespace

Subcommand explain_subcommand(Arguments& arguments) {
  const auto options = std::make_shared<ExplainOptions>();
  const FormatWord format = default_format();
  return {"explain", "tell of each artefact of an item whether it is cached, and if not what differs",
          planning_parameters(arguments, {{"ITEM", &options->item,
                                           "a mesh or point cloud (52), or a scan of a mesh (52_3)", true},
                                          {"STAGE", &options->stage, "this stage only"},
                                          format_parameter(format)}),
          [&arguments, options, format](const std::atomic<bool>&) {
            return print_explanation(arguments, *options, format_of(format));
          }};
}

}  // namespace salbench
