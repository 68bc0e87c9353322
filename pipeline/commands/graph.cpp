// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/graph.h"

#include <memory>

#include <fmt/format.h>

#include "pipeline/commands/installed.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/run/graph.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

std::string options_of(const Row& row, std::string_view between) {
  std::string text;
  for (const OptionLines& options : row.options) text += options.text;
  if (text.ends_with('\n')) text.pop_back();
  std::string joined;
  for (const char c : text) joined += c == '\n' ? std::string(between) : std::string(1, c);
  return joined;
}

std::string jobs_text(const std::vector<std::size_t>& to_do, std::size_t row) {
  return to_do.empty() ? "" : fmt::format(", {} to do", to_do[row]);
}

std::vector<std::size_t> open_jobs(const Setup& setup) {
  const FolderStore store(setup.cache, Access::read_only);
  std::vector<std::size_t> open;
  for (const std::vector<Job>& jobs : make_plan(setup.context, store).jobs) open.push_back(count_open(jobs));
  return open;
}

ExitStatus print_graph(const Arguments& arguments, const std::string& format) {
  if (format != "text" && format != "dot")
    throw ConfigError(fmt::format("--format {}: must be text or dot", format));
  const auto print = [&](const Catalog& catalog, const std::vector<std::size_t>& to_do) {
    fmt::print("{}", format == "dot" ? graph_dot(catalog, to_do) : graph_text(catalog, to_do));
  };
  if (arguments.data.empty()) {
    print(make_catalog(read_config(Section::from_file(configuration_path(arguments.config)), "")), {});
  } else {
    const Setup setup(arguments);
    print(setup.catalog, open_jobs(setup));
  }
  return kAllDone;
}

}  // namespace

std::string graph_text(const Catalog& catalog, const std::vector<std::size_t>& to_do) {
  std::string text;
  for (std::size_t r = 0; r < catalog.rows.size(); ++r) {
    const Row& row = catalog.rows[r];
    std::vector<std::string> inputs;
    for (const Edge& edge : edges(catalog))
      if (edge.to == r) inputs.push_back(node_name(catalog.rows[edge.from]));
    text +=
        fmt::format("{} (version {}, one per {}{}){}{}\n", node_name(row), row.version, name_of(row.scope()),
                    jobs_text(to_do, r), inputs.empty() ? "" : " <- ", fmt::join(inputs, ", "));
    if (const std::string options = options_of(row, ", "); !options.empty()) text += "  " + options + "\n";
  }
  return text;
}

std::string graph_dot(const Catalog& catalog, const std::vector<std::size_t>& to_do) {
  std::string dot =
      "digraph salbench {\n  rankdir=LR;\n  node [shape=box, style=rounded, fontname=\"sans-serif\"];\n";
  for (std::size_t r = 0; r < catalog.rows.size(); ++r) {
    const Row& row = catalog.rows[r];
    dot += fmt::format("  \"{}\" [label=\"{}\\n{}, version {}{}\", tooltip=\"{}\"{}];\n", node_name(row),
                       row.name, name_of(row.shapes), row.version, jobs_text(to_do, r),
                       options_of(row, "\\n"), row.gathers ? ", shape=ellipse" : "");
  }
  for (const Edge& edge : edges(catalog))
    dot += fmt::format("  \"{}\" -> \"{}\";\n", node_name(catalog.rows[edge.from]),
                       node_name(catalog.rows[edge.to]));
  return dot + "}\n";
}

Subcommand graph_subcommand(Arguments& arguments) {
  const auto format = std::make_shared<std::string>("text");
  return {"graph", "print the flow graph of a run: a node per row of the catalog, an edge per input",
          run_parameters(arguments, {{"--format", format.get(), "text (default), or dot for Graphviz"}}),
          [&arguments, format](const std::atomic<bool>&) { return print_graph(arguments, *format); }};
}

}  // namespace salbench
