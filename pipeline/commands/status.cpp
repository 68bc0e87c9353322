// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>
#include <optional>

#include <fmt/format.h>

#include "io/table.h"
#include "pipeline/commands/report.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/results/record.h"

namespace salbench {
namespace {

struct StatusReport {
  struct Stage {
    std::string stage;
    std::size_t done = 0, of = 0;  // jobs of this configuration
    std::size_t artefacts = 0;     // in the cache, of all configurations
    std::uint64_t bytes = 0;       // of these
  };
  std::vector<Stage> stages;
  std::size_t meshes = 0, clouds = 0;
  std::string shapes;  // these two in words
  std::size_t models = 0;
  std::filesystem::path cache;
  std::optional<std::string> last_run;  // as in run.yaml
  std::filesystem::path results;
};

Json json_of(const StatusReport& report) {
  return {{"stages", list_of(report.stages,
                             [](const StatusReport::Stage& stage) {
                               return Json{{"stage", stage.stage},
                                           {"done", stage.done},
                                           {"of", stage.of},
                                           {"artefacts", stage.artefacts},
                                           {"bytes", stage.bytes}};
                             })},
          {"meshes", report.meshes},
          {"clouds", report.clouds},
          {"models", report.models},
          {"cache", report.cache},
          {"last_run", report.last_run},
          {"results", report.results}};
}

StatusReport status_of(const Setup& setup) {
  const FolderStore store(setup.cache, Access::read_only);
  StatusReport report{.stages = {},
                      .meshes = setup.inputs.count(kMeshes),
                      .clouds = setup.inputs.count(kClouds),
                      .shapes = setup.inputs.text(),
                      .models = setup.config.models.size(),
                      .cache = setup.cache,
                      .last_run = {},
                      .results = setup.output};
  if (std::string state = state_of_results(setup.output); !state.empty()) report.last_run = std::move(state);
  std::map<std::string, FolderStore::Usage> usage;
  for (const FolderStore::Usage& stage : store.usage()) usage[stage.stage] = stage;
  for (const StageCount& count : count_by_stage(setup.project, make_plan(setup.project, store))) {
    const FolderStore::Usage& used = usage[count.stage];
    report.stages.push_back(
        {count.stage, count.cached, count.cached + count.compute + count.wait, used.artefacts, used.bytes});
  }
  return report;
}

std::string text_of(const StatusReport& report) {
  Table table{.columns = {"stage", "done", "of", "in the cache", "MB"}, .rows = {}};
  for (const StatusReport::Stage& stage : report.stages)
    table.rows.push_back({stage.stage, cell_of(stage.done), cell_of(stage.of), cell_of(stage.artefacts),
                          static_cast<double>(stage.bytes) / 1e6});
  return fmt::format("{}\ndata set: {}, {} models; cache: {}\n{}results: {}\n", aligned(table, 1),
                     report.shapes, report.models, report.cache.string(),
                     report.last_run ? fmt::format("last run: {}\n", *report.last_run) : "",
                     report.results.string());
}

ExitStatus print_status(const Arguments& arguments, ReportFormat format) {
  const StatusReport report = status_of(Setup(arguments, {}, Pictures::cached));
  print_report(format, "status", json_of(report), text_of(report));
  return kAllDone;
}

}  // namespace

Subcommand status_subcommand(Arguments& arguments) {
  const FormatWord format = default_format();
  return {
      "status", "count what is in the cache; changes nothing",
      planning_parameters(arguments, {output_parameter(arguments), format_parameter(format)}),
      [&arguments, format](const std::atomic<bool>&) { return print_status(arguments, format_of(format)); }};
}

}  // namespace salbench
