// SPDX-License-Identifier: GPL-3.0-or-later
// The graph of a run, as it is printed.
#include "pipeline/commands/graph.h"

#include <cstdlib>
#include <regex>
#include <set>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
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
  for (const GraphNode& node : graph.nodes) {
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

// The text of a quoted string of DOT, from the quote that opens it, as a label shows it; empties `dot` up to
// its end. Throws std::out_of_range if nothing closes it.
std::string take_label(std::string_view& dot) {
  std::string text;
  for (std::size_t i = 1;; ++i) {
    if (dot.at(i) == '"') {
      dot.remove_prefix(i + 1);
      return text;
    }
    if (dot.at(i) == '\\') {
      const char escaped = dot.at(++i);
      text += escaped == 'n' ? '\n' : escaped;
    } else if (dot.substr(i).starts_with("&amp;")) {
      text += '&';
      i += 4;
    } else {
      text += dot.at(i);
    }
  }
}

// Statements of the graph, each as its words and the quoted strings in them.
struct Statement {
  std::string words;  // "S [label=S,tooltip=S]", S for each string
  std::vector<std::string> strings = {};
};

std::vector<Statement> statements_in(std::string_view dot) {
  EXPECT_TRUE(dot.starts_with("digraph salbench {") && dot.ends_with("}\n"));
  dot = dot.substr(dot.find('{') + 1, dot.size() - dot.find('{') - 3);
  std::vector<Statement> statements(1);
  while (!dot.empty()) {
    if (dot[0] == '"') {
      statements.back().words += 'S';
      statements.back().strings.push_back(take_label(dot));
      continue;
    }
    if (dot[0] == ';')
      statements.emplace_back();
    else if (dot[0] != ' ' && dot[0] != '\n')
      statements.back().words += dot[0];
    dot.remove_prefix(1);
  }
  statements.pop_back();  // behind the last semicolon
  return statements;
}

// Quotes of a command had ended its string early.
TEST(GraphText, OfCommandsWithQuotesItIsValidDot) {
  const Graph graph = graph_of(make_rules(toy_config(
      R"(models: {MINE: {command: 'sh -c "awk ''{print $1 \"\\n\" & \\}'' {mesh} &amp; > {out}" \'}, RS: })")));
  const std::regex kNode(R"(S\[label=S,tooltip=S(,shape=ellipse)?\])"), kEdge(R"(S->S(\[style=dashed\])?)"),
      kSettings(R"(rankdir=LR|node\[shape=box,style=rounded,fontname=S\])");
  std::size_t told = 0;
  for (const Statement& statement : statements_in(graph_dot(graph))) {
    const std::string& words = statement.words;
    EXPECT_TRUE(std::regex_match(words, kNode) || std::regex_match(words, kEdge) ||
                std::regex_match(words, kSettings))
        << words;
    if (!std::regex_match(words, kNode)) continue;
    const GraphNode& node = graph.nodes.at(told++);
    EXPECT_EQ(statement.strings[0], node.name);
    EXPECT_EQ(statement.strings[2], fmt::format("{}", fmt::join(node.options, "\n")));
  }
  EXPECT_EQ(told, graph.nodes.size());
  const TemporaryFolder folder;
  const std::string file = folder.write("graph.dot", graph_dot(graph)).string();
  if (std::system("command -v dot > /dev/null 2>&1") == 0) {
    EXPECT_EQ(std::system(("dot -Tcanon '" + file + "' > /dev/null").c_str()), 0);
  }
}

}  // namespace
}  // namespace salbench
