// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "cache/layout.h"
#include "io/disk.h"
#include "io/table.h"
#include "pipeline/commands/graph.h"
#include "pipeline/commands/installed.h"
#include "pipeline/commands/report.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/commands/why.h"
#include "pipeline/results/record.h"
#include "pipeline/results/space.h"
#include "pipeline/results/stage_counts.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

struct PlanReport {
  std::vector<StageCount> stages;
  std::map<std::string, FolderStore::Usage> usage;  // of the cache, by all configurations
  std::size_t open = 0;                             // jobs to compute or waiting
  std::string shapes;                               // of the data set, in words
  std::size_t meshes = 0, clouds = 0, models = 0;
  std::filesystem::path cache, results;
  std::optional<std::string> last_run;  // as in run.yaml
  SpaceNeed need;
  FreeSpace free;
  std::optional<bool> locks;  // nothing: not tried, since there is no cache yet or it cannot be written to
};

Json reason_json(const std::pair<std::string, std::size_t>& reason) {
  return {{"why", reason.first}, {"jobs", reason.second}};
}

Json stage_json(const PlanReport& report, const StageCount& count) {
  const auto used = report.usage.find(count.stage);
  const FolderStore::Usage usage = used == report.usage.end() ? FolderStore::Usage() : used->second;
  return {{"stage", count.stage},   {"version", count.version},
          {"cached", count.cached}, {"to_compute", count.compute},
          {"waiting", count.wait},  {"not_applicable", count.not_applicable},
          {"failed", count.failed}, {"artefacts", usage.artefacts},
          {"bytes", usage.bytes},   {"reasons", list_of(count.reasons, reason_json)}};
}

Json json_of(const PlanReport& report) {
  const auto& [artefacts, by_cache, files, bytes] = report.need;
  return {
      {"stages", list_of(report.stages, [&](const StageCount& count) { return stage_json(report, count); })},
      {"open", report.open},
      {"meshes", report.meshes},
      {"clouds", report.clouds},
      {"models", report.models},
      {"cache", report.cache},
      {"results", report.results},
      {"last_run", report.last_run},
      {"need", {{"files", files}, {"bytes", bytes}}},
      {"free", {{"files", report.free.files}, {"bytes", report.free.bytes}}},
      {"locks", report.locks}};
}

PlanReport plan_of(const Setup& setup) {
  const FolderStore store(setup.cache, Access::read_only);
  const Plan plan = make_plan(setup.project, store);
  Causes causes(setup.project, plan, setup.cache, kOpenedForCounting);
  PlanReport report{.stages = count_by_stage(setup.project, plan, why_open(causes)),
                    .usage = {},
                    .shapes = setup.inputs.text(),
                    .meshes = setup.inputs.count(kMeshes),
                    .clouds = setup.inputs.count(kClouds),
                    .models = setup.config.models.size(),
                    .cache = setup.cache,
                    .results = setup.output,
                    .last_run = {},
                    .need = space_needed(setup.config, setup.inputs, setup.project, plan, store),
                    .free = free_space(existing_folder(setup.cache)),
                    .locks = locks_hold(setup.cache / kScratchFolder)};
  for (const StageCount& count : report.stages) report.open += count.compute + count.wait;
  for (const FolderStore::Usage& used : store.usage()) {
    report.usage[used.stage] = used;
    if (std::ranges::find(report.stages, used.stage, &StageCount::stage) == report.stages.end())
      report.stages.push_back({.stage = used.stage, .reasons = {}});  // of another configuration, or pictures
  }
  if (std::string state = state_of_results(setup.output); !state.empty()) report.last_run = std::move(state);
  return report;
}

std::string table_text(const PlanReport& report) {
  Table table{.columns = {"stage", "cached", "to compute", "waiting", "not applicable", "failed",
                          "in the cache", "MB", "why"},
              .rows = {}};
  for (const StageCount& count : report.stages) {
    std::string reasons;
    for (const auto& [reason, n] : count.reasons)
      reasons += fmt::format("{}{}: {}", reasons.empty() ? "" : "; ", reason, n);
    const auto used = report.usage.find(count.stage);
    const FolderStore::Usage usage = used == report.usage.end() ? FolderStore::Usage() : used->second;
    table.rows.push_back({count.stage, cell_of(count.cached), cell_of(count.compute), cell_of(count.wait),
                          cell_of(count.not_applicable), cell_of(count.failed), cell_of(usage.artefacts),
                          static_cast<double>(usage.bytes) / 1e6, reasons});
  }
  return aligned(table, 1);
}

// Disk that the run needs and that is free, and advice where it does not suffice or has no locks.
std::string disk_text(const PlanReport& report) {
  const std::string left = report.free.bytes < FreeSpace::kNoLimit
                               ? fmt::format("{} free", bytes_text(report.free.bytes))
                               : "how much is free is not known";
  std::string text = report.open == 0 ? fmt::format("disk: {}\n", left)
                                      : fmt::format("disk: {} needed, {}\n", text_of(report.need), left);
  if (const std::string lacking = shortage(report.need, report.free); !lacking.empty())
    text += fmt::format("disk: {}\n", lacking);
  if (report.locks == false)
    text +=
        "disk: it has no locks: run one process at a time, or give each its --shard; others repeat work\n";
  return text;
}

std::string text_of(const PlanReport& report) {
  return fmt::format("{}\ndata set: {}, {} models; cache: {}\n{}results: {}\n{}{} jobs to do{}\n",
                     table_text(report), report.shapes, report.models, report.cache.string(),
                     report.last_run ? fmt::format("last run: {}\n", *report.last_run) : "",
                     report.results.string(), disk_text(report), report.open,
                     report.open > 0 ? "; a waiting job is skipped if its input turns out unchanged" : "");
}

// Without a data set, and options about one, the graph has the rules alone and counts no jobs.
Graph graph_of_run(const Arguments& arguments) {
  const Config config = read_config(configuration(arguments.config), "");
  const bool of_data = arguments.split || !(arguments.data + arguments.cache + arguments.items +
                                            arguments.reference + arguments.shard + config.data)
                                               .empty();
  if (!of_data) return graph_of(make_rules(config));
  const Setup setup(arguments);
  const FolderStore store(setup.cache, Access::read_only);
  const Plan plan = make_plan(setup.project, store);
  Graph graph = graph_of(setup.project.rules);
  for (std::size_t rule = 0; rule < graph.nodes.size(); ++rule) graph.nodes[rule].to_do = plan.open(rule);
  return graph;
}

ExitStatus print_plan(const Arguments& arguments, bool graph, ReportFormat format) {
  if (format == ReportFormat::dot && !graph)
    throw ConfigError("--format dot: only a graph has that form; give --graph, too");
  if (graph) {
    if (!arguments.output.empty()) throw ConfigError("--out: a graph names no results; leave out --graph");
    const Graph nodes = graph_of_run(arguments);
    print_report(format, "graph", graph_json(nodes),
                 format == ReportFormat::dot ? graph_dot(nodes) : graph_text(nodes));
    return kAllDone;
  }
  const PlanReport report = plan_of(Setup(arguments));
  print_report(format, "plan", json_of(report), text_of(report));
  return kAllDone;
}

}  // namespace

Subcommand plan_subcommand(Arguments& arguments) {
  const auto graph = std::make_shared<bool>(false);
  const FormatWord format = default_format();
  return {
      "plan",
      "count what is in the cache, what a run would compute and why, and what it needs; changes nothing",
      planning_parameters(
          arguments,
          {output_parameter(arguments),
           shard_parameter(arguments),
           {"--graph", graph.get(),
            "the flow graph in place of the counts: a node per rule, its inputs, and its open jobs if there "
            "is a data set"},
           format_parameter(format, ", or dot for Graphviz (of --graph)")}),
      [&arguments, graph, format](const std::atomic<bool>&) {
        return print_plan(arguments, *graph, format_of(format, true));
      }};
}

}  // namespace salbench
