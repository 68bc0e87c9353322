// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/graph.h"

#include <sstream>

#include <fmt/format.h>

#include "pipeline/commands/installed.h"
#include "pipeline/commands/report.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/run/graph.h"

namespace salbench {
namespace {

std::vector<std::string> option_lines(const Row& row) {
  std::vector<std::string> lines;
  for (const OptionLines& options : row.options) {
    std::istringstream text(options.text);
    for (std::string line; std::getline(text, line);) lines.push_back(line);
  }
  return lines;
}

std::string jobs_text(const GraphNode& node) {
  return node.to_do ? fmt::format(", {} to do", *node.to_do) : "";
}

Json::Object json_of(const Graph& graph) {
  const auto words = [](const std::vector<std::string>& list) {
    return Json::List(list.begin(), list.end());
  };
  return {{"nodes", Json::list(graph.nodes, [&](const GraphNode& node) {
             return Json{{"node", node.name},
                         {"stage", node.stage},
                         {"shapes", node.shapes},
                         {"per", node.per},
                         {"version", node.version},
                         {"options", words(node.options)},
                         {"inputs", words(node.inputs)},
                         {"to_do", node.to_do}};
           })}};
}

std::vector<std::size_t> open_jobs(const Setup& setup) {
  const FolderStore store(setup.cache, Access::read_only);
  std::vector<std::size_t> open;
  for (const std::vector<Job>& jobs : make_plan(setup.context, store).jobs) open.push_back(count_open(jobs));
  return open;
}

Graph graph_of_run(const Arguments& arguments) {
  if (arguments.data.empty())
    return graph_of(make_catalog(read_config(Section::from_file(configuration_path(arguments.config)), "")));
  const Setup setup(arguments);
  return graph_of(setup.catalog, open_jobs(setup));
}

ExitStatus print_graph(const Arguments& arguments, ReportFormat format) {
  const Graph graph = graph_of_run(arguments);
  print_report(format, "graph", json_of(graph),
               format == ReportFormat::dot ? graph_dot(graph) : graph_text(graph));
  return kAllDone;
}

}  // namespace

Graph graph_of(const Catalog& catalog, const std::vector<std::size_t>& to_do) {
  Graph graph;
  for (const Row& row : catalog.rows)
    graph.nodes.push_back({.name = node_name(row),
                           .stage = row.name,
                           .shapes = name_of(row.shapes),
                           .per = name_of(row.scope()),
                           .version = row.version,
                           .options = option_lines(row)});
  for (const Edge& edge : edges(catalog)) graph.nodes[edge.to].inputs.push_back(graph.nodes[edge.from].name);
  for (std::size_t row = 0; row < to_do.size(); ++row) graph.nodes[row].to_do = to_do[row];
  return graph;
}

std::string graph_text(const Graph& graph) {
  std::string text;
  for (const GraphNode& node : graph.nodes) {
    text += fmt::format("{} (version {}, one per {}{}){}{}\n", node.name, node.version, node.per,
                        jobs_text(node), node.inputs.empty() ? "" : " <- ", fmt::join(node.inputs, ", "));
    if (!node.options.empty()) text += fmt::format("  {}\n", fmt::join(node.options, ", "));
  }
  return text;
}

std::string graph_dot(const Graph& graph) {
  std::string nodes, edges;
  for (const GraphNode& node : graph.nodes) {
    nodes += fmt::format("  \"{}\" [label=\"{}\\n{}, version {}{}\", tooltip=\"{}\"{}];\n", node.name,
                         node.stage, node.shapes, node.version, jobs_text(node),
                         fmt::join(node.options, "\\n"), node.per == "set" ? ", shape=ellipse" : "");
    for (const std::string& input : node.inputs)
      edges += fmt::format("  \"{}\" -> \"{}\";\n", input, node.name);
  }
  return "digraph salbench {\n  rankdir=LR;\n  node [shape=box, style=rounded, fontname=\"sans-serif\"];\n" +
         nodes + edges + "}\n";
}

Subcommand graph_subcommand(Arguments& arguments) {
  const FormatWord format = default_format();
  return {"graph", "print the flow graph of a run: a node per row of the catalog, an edge per input",
          run_parameters(arguments, {format_parameter(format, ", or dot for Graphviz")}),
          [&arguments, format](const std::atomic<bool>&) {
            return print_graph(arguments, format_of(format, true));
          }};
}

}  // namespace salbench
