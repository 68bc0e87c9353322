// SPDX-License-Identifier: GPL-3.0-or-later
// What a run would compute, and the flow graph of it, with its cuts, as `salbench plan --graph` shows it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/commands/report.h"
#include "pipeline/commands/session.h"
#include "pipeline/engine/rule.h"

namespace salbench {

// What `salbench plan` says of a run: as members of its document, and as text.
struct PlanReport {
  Json members;
  std::string text;
};
PlanReport plan_report(const Setup& setup);

// `salbench plan CONFIG ITEM [STAGE]`: the state of each stage of an item, or of one with its recipe beside
// those of the cache. stage: empty for all. Throws ConfigError if there is no such item or stage.
ExitStatus print_plan_of_item(const Arguments& arguments, const std::string& item, const std::string& stage);

struct GraphNode {
  std::string name, stage;       // "fpfh of scans", "fpfh"
  std::string_view shapes, per;  // "scans", "scan"
  std::int32_t version = 0;
  std::vector<std::string> options = {};  // "radius: 0.02"
  std::vector<std::string> inputs = {};   // names of nodes, all of them
  std::vector<std::string> cuts = {};     // of these, inputs of earlier strata: read back from the cache
  std::size_t stratum = 0;                // streamed one after the other
  std::optional<std::size_t> to_do = {};  // open jobs; nothing if no data set was looked at
};
using Graph = std::vector<GraphNode>;  // in the order of the rules

Graph graph_of(const Rules& rules);
std::string graph_text(const Graph& graph);  // a line per node, and one of its options; by stratum
std::string graph_dot(const Graph& graph);   // for Graphviz

}  // namespace salbench
