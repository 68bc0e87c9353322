// SPDX-License-Identifier: GPL-3.0-or-later
// The graph of a run.

#include "pipeline/run/plan.h"
#include "tests/support/test.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

using Pair = std::pair<std::string, std::string>;

std::multiset<Pair> edges_of(const Graph& graph) {
  std::multiset<Pair> edges;
  for (const GraphNode& node : graph)
    for (const std::string& input : node.inputs) edges.emplace(input, node.name);
  return edges;
}

TEST(GraphOfARun, OfTheDefaultConfigurationItIsTheTableOfRulesNodeForNodeAndEdgeForEdge) {
  const Rules rules = make_rules(toy_config(""));
  const Graph graph = graph_of(rules);
  std::multiset<Pair> expected;
  for (std::size_t rule = 0; rule < rules.size(); ++rule) {
    EXPECT_EQ(graph[rule].name, node_name(rules[rule]));
    for (const std::size_t input : rules[rule].inputs)
      expected.emplace(node_name(rules[input]), node_name(rules[rule]));
  }
  EXPECT_EQ(edges_of(graph), expected);
  // Some edges of the paper's figure.
  EXPECT_THAT(edges_of(graph), IsSupersetOf({Pair("mesh of meshes", "scan of scans"),
                                             Pair("scan_normals of scans", "fpfh of scans"),
                                             Pair("fpfh of scans", "map.LS of scans"),
                                             Pair("reference of scans", "matched.LS of scans"),
                                             Pair("matched.LS of scans", "scores.LS of scans")}));
}

// Maps need no gathered value, yet lie behind the cut: before it, they would have to be read back.
TEST(GraphOfARun, CutsLieBehindWhatTheReferenceIsMadeOf) {
  for (const GraphNode& node : graph_of(make_rules(toy_config("")))) {
    const bool first = node.stage == "mesh" || node.stage == "scan" || node.stage == "reference" ||
                       node.stage.ends_with("ground_truth");
    EXPECT_EQ(node.stratum, first ? 0U : 1U) << node.name;
    if (first) {
      EXPECT_THAT(node.cuts, IsEmpty());
    }
    if (node.name == "matched.LS of meshes") {
      EXPECT_THAT(node.cuts, ElementsAre("reference of meshes"));
      EXPECT_THAT(node.inputs, Contains("map.LS of meshes"));
    }
  }
}

}  // namespace
}  // namespace salbench
