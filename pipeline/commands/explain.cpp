// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/explain.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "io/table.h"
#include "pipeline/commands/report.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/config/section.h"
#include "pipeline/plan/causes.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

Item require_item(const Context& context, const std::string& name) {
  if (const auto item = find_item(context, name)) return *item;
  throw ConfigError(
      fmt::format("explain: there is no item '{}'; a shape is named like its file (52), the scans of a mesh "
                  "52_0 to 52_11",
                  name));
}

void require_stage(const Context& context, const std::vector<JobRef>& jobs, const ExplainOptions& options) {
  std::vector<std::string_view> known;
  for (const JobRef& job : jobs) known.push_back(context.row(job).name);
  if (options.stage.empty() || std::find(known.begin(), known.end(), options.stage) != known.end()) return;
  const std::string nearest = nearest_word(options.stage, known);
  throw ConfigError(fmt::format("explain: {} has no stage '{}'; {}", options.item, options.stage,
                                nearest.empty() ? fmt::format("it has {}", fmt::join(known, ", "))
                                                : fmt::format("did you mean '{}'?", nearest)));
}

std::string state_of(const Job& job, const Cause& cause) {
  if (cause.reason == Reason::damaged) return "damaged";
  switch (job.verdict) {
    case Verdict::cached:
    case Verdict::done:
      return "cached";
    case Verdict::compute:
      return "to compute";
    case Verdict::wait:
      return "waiting";
    default:
      return "not applicable";
  }
}

}  // namespace

std::vector<Explanation> explain(const Context& context, const Plan& plan, const std::filesystem::path& cache,
                                 const ExplainOptions& options) {
  const std::vector<JobRef> jobs = jobs_of(context.catalog, require_item(context, options.item));
  require_stage(context, jobs, options);
  Causes causes(context, plan, cache);
  std::vector<Explanation> explanations;
  for (const JobRef& job : jobs) {
    const std::string& stage = context.row(job).name;
    if (!options.stage.empty() && stage != options.stage) continue;
    const Cause cause = causes.of(job, true);
    explanations.push_back({stage, state_of(plan[job], cause), causes.line(job, cause), cause.file});
  }
  return explanations;
}

namespace {

struct ExplainReport {
  ExplainOptions asked;
  std::vector<Explanation> stages;
};

Json::Object json_of(const ExplainReport& report) {
  return {{"item", report.asked.item},
          {"stages", Json::list(report.stages, [](const Explanation& stage) {
             return Json{{"stage", stage.stage},
                         {"state", stage.state},
                         {"why", stage.why},
                         {"file", stage.file.empty() ? std::nullopt : std::optional(stage.file)}};
           })}};
}

ExplainReport explained(const Setup& setup, const ExplainOptions& options) {
  const FolderStore store(setup.cache, Access::on_demand);
  return {options, explain(setup.context, make_plan(setup.context, store), setup.cache, options)};
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
          run_parameters(arguments, {{"ITEM", &options->item,
                                      "a mesh or point cloud (52), or a scan of a mesh (52_3)", true},
                                     {"STAGE", &options->stage, "this stage only"},
                                     format_parameter(format)}),
          [&arguments, options, format](const std::atomic<bool>&) {
            return print_explanation(arguments, *options, format_of(format));
          }};
}

}  // namespace salbench
