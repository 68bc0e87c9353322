// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/plan.h"

#include <algorithm>
#include <map>
#include <memory>
#include <sstream>

#include <fmt/format.h>

#include "io/table.h"
#include "pipeline/commands/cli.h"
#include "pipeline/commands/report.h"
#include "pipeline/engine/run.h"
#include "pipeline/inputs/inputs.h"
#include "pipeline/results/counts.h"
#include "pipeline/results/record.h"
#include "pipeline/rules/rules.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

// --- the counts -------------------------------------------------------------------------------------------

// A row for each stage of the run, and for those that the cache has by other configurations, or pictures.
Json stage_rows(const std::vector<StageCount>& counts, const FolderStore& store) {
  std::map<std::string, FolderStore::Usage> usage;
  for (const FolderStore::Usage& used : store.usage()) usage[used.stage] = used;
  const auto row = [&](const StageCount& count) {
    const FolderStore::Usage used = usage[count.stage];
    usage.erase(count.stage);
    return Json{{"stage", count.stage},
                {"version", count.version},
                {"cached", count.cached},
                {"to_compute", count.compute},
                {"waiting", count.wait},
                {"not_applicable", count.not_applicable},
                {"failed", count.failed},
                {"artefacts", used.artefacts},
                {"bytes", used.bytes},
                {"reasons", list_of(count.reasons, [](const auto& reason) {
                   return Json{{"why", reason.first}, {"jobs", reason.second}};
                 })}};
  };
  Json rows = list_of(counts, row);
  for (const FolderStore::Usage& used : store.usage())
    if (usage.contains(used.stage)) rows.push_back(row({.stage = used.stage}));
  return rows;
}

std::string table_text(const Json& rows) {
  Table table{.columns = {"stage", "cached", "to compute", "waiting", "not applicable", "failed",
                          "in the cache", "MB", "why"},
              .rows = {}};
  for (const Json& row : rows) {
    std::vector<Cell>& cells = table.rows.emplace_back();
    cells.emplace_back(row["stage"].get<std::string>());
    for (const char* key : {"cached", "to_compute", "waiting", "not_applicable", "failed", "artefacts"})
      cells.push_back(cell_of(row[key].get<std::size_t>()));
    cells.emplace_back(row["bytes"].get<double>() / 1e6);
    std::string why;
    for (const Json& reason : row["reasons"])
      why += fmt::format("{}{}: {}", why.empty() ? "" : "; ", reason["why"].get<std::string>(),
                         reason["jobs"].get<std::size_t>());
    cells.emplace_back(why);
  }
  return aligned(table, 1);
}

// One line on what the cache has beside.
std::string others_text(const Json& rows) {
  std::vector<std::string> stages;
  std::size_t artefacts = 0;
  double bytes = 0;
  for (const Json& row : rows) {
    stages.push_back(row["stage"].get<std::string>());
    artefacts += row["artefacts"].get<std::size_t>();
    bytes += row["bytes"].get<double>();
  }
  return stages.empty()
             ? ""
             : fmt::format(
                   "also in the cache, of no stage of this configuration: {} artefacts, {:.1f} MB, of {} "
                   "(--all lists them)\n",
                   artefacts, bytes / 1e6, fmt::join(stages, ", "));
}

// all: the text has a row for each stage that the cache has beside those of the configuration, too.
PlanReport report_of(const Setup& setup, bool all) {
  const auto& [selection, config, inputs, project, cache, output] = setup;
  const FolderStore store(cache, Access::read_only);
  const Plan plan = make_plan(project, store);
  const std::vector<StageCount> counts = count_by_stage(project, plan, Counted::open);
  const Json stages = stage_rows(counts, store);
  Json shown = Json::array(), others = Json::array();
  for (std::size_t row = 0; row < stages.size(); ++row)
    (all || row < counts.size() ? shown : others).push_back(stages[row]);
  std::size_t open = 0;  // jobs to compute or waiting
  for (const StageCount& count : counts) open += count.compute + count.wait;
  const std::string last_run = state_of_results(output);  // as in run.yaml
  return {
      {{"stages", stages},
       {"open", open},
       {"meshes", inputs.count(kMeshes)},
       {"clouds", inputs.count(kClouds)},
       {"models", config.models.size()},
       {"cache", cache},
       {"results", output},
       {"last_run", last_run.empty() ? Json() : Json(last_run)}},
      fmt::format("{}\n{}data set: {}, {} models; cache: {}\n{}results: {}\n{} jobs to do{}\n",
                  table_text(shown), others_text(others), inputs.text(), config.models.size(), cache.string(),
                  last_run.empty() ? "" : fmt::format("last run: {}\n", last_run), output.string(), open,
                  open > 0 ? "; a waiting job is skipped if its input turns out unchanged" : "")};
}

ExitStatus print_plan(const Arguments& arguments, bool all) {
  const PlanReport report = report_of(Setup(arguments), all);
  print_report(arguments.format, "plan", report.members, report.text);
  return kAllDone;
}

// --- the graph --------------------------------------------------------------------------------------------

std::vector<std::string> option_lines(const Rule& rule) {
  std::vector<std::string> lines;
  for (const OptionLines& options : rule.options) {
    std::istringstream text(options.text);
    for (std::string line; std::getline(text, line);) lines.push_back(line);
  }
  return lines;
}

// A quoted string of DOT. Labels are read for escapes and for entities of HTML, too.
std::string dot_text(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c == '&' ? std::string("&amp;") : c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  return quoted + '"';
}

std::string jobs_text(const GraphNode& node) {
  return node.to_do ? fmt::format(", {} to do", *node.to_do) : "";
}

Json node_json(const GraphNode& node) {
  return {{"node", node.name},       {"stage", node.stage},     {"shapes", node.shapes}, {"per", node.per},
          {"version", node.version}, {"options", node.options}, {"inputs", node.inputs}, {"cuts", node.cuts},
          {"stratum", node.stratum}, {"to_do", node.to_do}};
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
  for (std::size_t rule = 0; rule < graph.size(); ++rule) graph[rule].to_do = plan.open(rule);
  return graph;
}

ExitStatus print_graph(const Arguments& arguments) {
  const Graph graph = graph_of_run(arguments);
  print_report(arguments.format, "graph", {{"nodes", list_of(graph, node_json)}},
               arguments.format == "dot" ? graph_dot(graph) : graph_text(graph));
  return kAllDone;
}

}  // namespace

PlanReport plan_report(const Setup& setup) { return report_of(setup, false); }

Graph graph_of(const Rules& rules) {
  const std::vector<std::size_t> stratum = strata(rules);
  Graph graph;
  for (std::size_t r = 0; r < rules.size(); ++r) {
    const Rule& rule = rules[r];
    graph.push_back({.name = node_name(rule),
                     .stage = rule.stage,
                     .shapes = shapes_name(rule.over),
                     .per = levels()[rule.level()].unit,
                     .version = rule.version,
                     .options = option_lines(rule),
                     .stratum = stratum[r]});
    for (const std::size_t input : rule.inputs) {
      graph[r].inputs.push_back(graph[input].name);
      if (stratum[input] < stratum[r]) graph[r].cuts.push_back(graph[input].name);
    }
  }
  return graph;
}

std::string graph_text(const Graph& graph) {
  std::map<std::size_t, std::string> strata;
  for (const GraphNode& node : graph) {
    std::string& text = strata[node.stratum];
    text += fmt::format("{} (version {}, one per {}{}){}{}{}\n", node.name, node.version, node.per,
                        jobs_text(node), node.inputs.empty() ? "" : " <- ", fmt::join(node.inputs, ", "),
                        node.cuts.empty() ? "" : fmt::format("; read back: {}", fmt::join(node.cuts, ", ")));
    if (!node.options.empty()) text += fmt::format("  {}\n", fmt::join(node.options, ", "));
  }
  std::string text;
  for (const auto& [stratum, nodes] : strata)
    text +=
        fmt::format("{}stratum {} of {}\n{}", text.empty() ? "" : "\n", stratum + 1, strata.size(), nodes);
  return text;
}

std::string graph_dot(const Graph& graph) {
  std::string nodes, edges;
  for (const GraphNode& node : graph) {
    const std::string label =
        fmt::format("{}\n{}, version {}{}", node.stage, node.shapes, node.version, jobs_text(node));
    nodes += fmt::format("  {} [label={}, tooltip={}{}];\n", dot_text(node.name), dot_text(label),
                         dot_text(fmt::format("{}", fmt::join(node.options, "\n"))),
                         node.per == "set" ? ", shape=ellipse" : "");
    for (const std::string& input : node.inputs)
      edges += fmt::format("  {} -> {}{};\n", dot_text(input), dot_text(node.name),
                           std::ranges::find(node.cuts, input) == node.cuts.end() ? "" : " [style=dashed]");
  }
  return "digraph salbench {\n  rankdir=LR;\n  node [shape=box, style=rounded, fontname=\"sans-serif\"];\n" +
         nodes + edges + "}\n";
}

Action plan_subcommand(CLI::App& program) {
  struct PlanArguments : Arguments {
    std::string item, stage;
  };
  const auto arguments = std::make_shared<PlanArguments>();
  CLI::App& app = add_subcommand(
      program, "plan", "count what is in the cache, and what a run would compute and why; changes nothing",
      {{"plan configs/shrec07.yaml --data SchellingData", "what a run would compute, and why"},
       {"plan configs/shrec07.yaml 52_3 --data SchellingData", "each stage of one scan"},
       {"plan configs/shrec07.yaml 52 map.LS --data SchellingData",
        "how the recipe of a map differs from those in the cache"},
       {"plan configs/shrec07.yaml --graph --format dot | dot -Tsvg",
        "the flow graph of a run, as a picture"}});
  add_planning(app, *arguments);
  CLI::Option* item = app.add_option(
      "ITEM", arguments->item,
      "a mesh or point cloud (52), or a scan of a mesh (52_3): its stages in place of the counts");
  app.add_option("STAGE", arguments->stage,
                 "of the item, this stage only, with its recipe beside those in the cache");
  CLI::Option* output = add_output(app, *arguments);
  add_shard(app, *arguments);
  const CLI::Option* graph = app.add_flag("--graph")
                                 ->description(
                                     "the flow graph in place of the counts: a node per rule, its inputs, "
                                     "and its open jobs if there is a data set")
                                 ->excludes(output)
                                 ->excludes(item);
  const CLI::Option* all = app.add_flag("--all")
                               ->description(
                                   "also a row for each stage that the cache has of other configurations; "
                                   "without it they are one line")
                               ->excludes(item);
  add_format(app, *arguments, {"text", "json", "dot"}, ", or dot for Graphviz (of --graph)");
  return [arguments, graph, all] {
    if (*graph) return print_graph(*arguments);
    if (arguments->format == "dot")
      throw ConfigError("--format dot: only a graph has that form; give --graph, too");
    if (!arguments->item.empty()) return print_plan_of_item(*arguments, arguments->item, arguments->stage);
    return print_plan(*arguments, static_cast<bool>(*all));
  };
}

}  // namespace salbench
