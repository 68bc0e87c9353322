// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/graph.h"

#include <algorithm>
#include <map>
#include <sstream>

#include <fmt/format.h>

#include "pipeline/engine/run.h"

namespace salbench {
namespace {

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

}  // namespace

Graph graph_of(const Rules& rules) {
  const std::vector<std::size_t> stratum = strata(rules);
  Graph graph;
  for (std::size_t r = 0; r < rules.size(); ++r) {
    const Rule& rule = rules[r];
    graph.nodes.push_back({.name = node_name(rule),
                           .stage = rule.stage,
                           .shapes = shapes_name(rule.over),
                           .per = levels()[rule.level()].unit,
                           .version = rule.version,
                           .options = option_lines(rule),
                           .stratum = stratum[r]});
    for (const std::size_t input : rule.inputs) {
      graph.nodes[r].inputs.push_back(graph.nodes[input].name);
      if (stratum[input] < stratum[r]) graph.nodes[r].cuts.push_back(graph.nodes[input].name);
    }
  }
  return graph;
}

std::string graph_text(const Graph& graph) {
  std::map<std::size_t, std::string> strata;
  for (const GraphNode& node : graph.nodes) {
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
  for (const GraphNode& node : graph.nodes) {
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

Json graph_json(const Graph& graph) {
  const auto words = [](const std::vector<std::string>& list) { return Json(list); };
  return {{"nodes", list_of(graph.nodes, [&](const GraphNode& node) {
             return Json{{"node", node.name},
                         {"stage", node.stage},
                         {"shapes", node.shapes},
                         {"per", node.per},
                         {"version", node.version},
                         {"options", words(node.options)},
                         {"inputs", words(node.inputs)},
                         {"cuts", words(node.cuts)},
                         {"stratum", node.stratum},
                         {"to_do", node.to_do}};
           })}};
}

}  // namespace salbench
