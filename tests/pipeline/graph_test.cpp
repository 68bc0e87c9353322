// SPDX-License-Identifier: GPL-3.0-or-later
// The graph of a run, as it is printed.
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/commands/plan.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

using testing::HasSubstr;
using testing::IsSupersetOf;

using Pair = std::pair<std::string, std::string>;

std::multiset<Pair> edges_in(const std::string& dot) {
  std::multiset<Pair> found;
  for (std::size_t at = dot.find("\" -> \""); at != std::string::npos; at = dot.find("\" -> \"", at + 1)) {
    const std::size_t begin = dot.rfind('"', at - 1) + 1, end = dot.find('"', at + 6);
    found.emplace(dot.substr(begin, at - begin), dot.substr(at + 6, end - at - 6));
  }
  return found;
}

TEST(GraphText, OfTheDefaultConfigurationItIsTheTableOfRulesNodeForNodeAndEdgeForEdge) {
  const Rules rules = make_rules(toy_config(""));
  const std::string dot = graph_dot(graph_of(rules)), text = graph_text(graph_of(rules));
  std::multiset<Pair> expected;
  for (const Rule& rule : rules) {
    EXPECT_THAT(dot, testing::HasSubstr("  \"" + node_name(rule) + "\" ["));
    EXPECT_THAT("\n" + text, testing::HasSubstr("\n" + node_name(rule) + " (version "));
    for (const std::size_t input : rule.inputs) expected.emplace(node_name(rules[input]), node_name(rule));
  }
  EXPECT_EQ(edges_in(dot), expected);
  // A few that the paper's figure has.
  EXPECT_THAT(edges_in(dot), IsSupersetOf({Pair("mesh of meshes", "scan of scans"),
                                           Pair("scan_normals of scans", "fpfh of scans"),
                                           Pair("fpfh of scans", "map.LS of scans"),
                                           Pair("reference of scans", "matched.LS of scans"),
                                           Pair("matched.LS of scans", "scores.LS of scans")}));
}

// Maps wait for nothing that is gathered, yet lie behind the cut: before it they would be read back.
TEST(GraphText, CutsLieBehindWhatTheReferenceIsMadeOf) {
  const Graph graph = graph_of(make_rules(toy_config("")));
  for (const GraphNode& node : graph) {
    const bool first = node.stage == "mesh" || node.stage == "scan" || node.stage == "reference" ||
                       node.stage.ends_with("ground_truth");
    EXPECT_EQ(node.stratum, first ? 0U : 1U) << node.name;
    if (first) {
      EXPECT_THAT(node.cuts, testing::IsEmpty());
    }
  }
  const std::string dot = graph_dot(graph), text = graph_text(graph);
  EXPECT_THAT(dot, HasSubstr("\"reference of meshes\" -> \"matched.LS of meshes\" [style=dashed];"));
  EXPECT_THAT(dot, HasSubstr("\"map.LS of meshes\" -> \"matched.LS of meshes\";"));
  EXPECT_THAT(text, HasSubstr("\nstratum 2 of 2\n"));
  EXPECT_THAT(text, HasSubstr("; read back: reference of meshes"));
}

// They had ended the string early.
TEST(GraphText, QuotesOfCommandsAreEscaped) {
  const std::string dot = graph_dot(graph_of(
      make_rules(toy_config(R"(models: {MINE: {command: 'cut "a" \ &amp; {mesh} > {out}'}, RS: })"))));
  EXPECT_THAT(dot, HasSubstr(R"(command: \"cut \\\"a\\\" \\\\ &amp;amp; {mesh} > {out}\")"));
}

}  // namespace
}  // namespace salbench
