// SPDX-License-Identifier: GPL-3.0-or-later
// What a text says of pairs of models, beside what scores say.
#include "pipeline/results/statements.h"

#include <cmath>
#include <cstdlib>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "pipeline/results/score_file.h"
#include "stages/core/errors.h"
#include "stages/core/rng.h"
#include "tests/support/data.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr const char* kHead = "section,claim,word,dataset,metric,check,a,b,margin\n";

// 40 scans of meshes whose scores differ much; model B is A with `ahead` taken off and noise of its own.
ScoreFile scores_of(double ahead, double noise, const std::string& metric = "auc") {
  Rng rng(1, "statements", "");
  TemporaryFolder folder;
  std::string text = "item,view,model," + metric + "\n";
  for (int mesh = 0; mesh < 20; ++mesh) {
    const double of_mesh = rng.normal(), of_pair = noise * rng.normal();
    for (int view = 0; view < 2; ++view) {
      text += fmt::format("{},{},A,{}\n", mesh, view, of_mesh);
      text += fmt::format("{},{},B,{}\n", mesh, view, of_mesh - ahead + of_pair);
    }
  }
  return read_scores(folder.write("scores.csv", text));
}

// The cells of the only row, by column.
std::map<std::string, Cell> answer(const ScoreFile& file, const std::string& statement) {
  TemporaryFolder folder;
  const Conclusions conclusions = conclude(file.rows, file.metrics, {}, 1);
  const Table table = statements_table(
      conclusions,
      read_statements(folder.write("claims.csv", kHead + ("4,it is so,word," + statement) + "\n")));
  EXPECT_THAT(table.rows, SizeIs(1));
  std::map<std::string, Cell> cells;
  for (std::size_t c = 0; c < table.columns.size(); ++c) cells[table.columns[c]] = table.rows.at(0).at(c);
  return cells;
}

std::string by_units(const ScoreFile& file, const std::string& statement) {
  return std::get<std::string>(answer(file, statement).at("by_units"));
}

std::string by_shapes(const ScoreFile& file, const std::string& statement) {
  return std::get<std::string>(answer(file, statement).at("by_shapes"));
}

TEST(Statements, ADifferenceHoldsOnTheSideClaimed) {
  const ScoreFile clear = scores_of(1, .2), noisy = scores_of(.01, .2);
  EXPECT_EQ(by_units(clear, "scans,auc,above,A,B,"), "holds");
  EXPECT_EQ(by_units(clear, "scans,auc,above,B,A,"), "does not hold");
  EXPECT_EQ(by_units(noisy, "scans,auc,above,A,B,"), "undecided");
  EXPECT_EQ(by_units(scores_of(1, .2, "kl"), "scans,kl,above,B,A,"), "holds") << "lower values are better";
}

TEST(Statements, SamenessTakesAMargin) {
  const ScoreFile clear = scores_of(1, .2), noisy = scores_of(.01, .2);
  EXPECT_EQ(by_units(noisy, "scans,auc,same,A,B,.5"), "holds");
  EXPECT_EQ(by_units(noisy, "scans,auc,same,A,B,.01"), "undecided");
  EXPECT_EQ(by_units(noisy, "scans,auc,same,A,B,"), "undecided") << "without a margin, nothing is the same";
  EXPECT_EQ(by_units(clear, "scans,auc,same,A,B,.5"), "does not hold");
  EXPECT_EQ(by_units(noisy, "scans,auc,differ,A,B,.5"), "does not hold");
  EXPECT_EQ(by_units(noisy, "scans,auc,differ,A,B,.01"), "undecided");
  EXPECT_EQ(by_units(clear, "scans,auc,differ,B,A,.01"), "holds");
}

TEST(Statements, ThePapersTestTakesShapesAndReadsWhatItDoesNotRejectAsSame) {
  const ScoreFile apart = scores_of(9, .2), near = scores_of(.15, .2);
  EXPECT_EQ(by_shapes(apart, "scans,auc,above,A,B,"), "holds");
  EXPECT_EQ(by_shapes(apart, "scans,auc,above,B,A,"), "does not hold");
  EXPECT_EQ(by_shapes(apart, "scans,auc,same,A,B,"), "does not hold");
  EXPECT_EQ(by_shapes(apart, "scans,auc,differ,A,B,"), "holds");
  EXPECT_EQ(by_shapes(near, "scans,auc,same,A,B,"), "holds") << "it does not see that shapes are paired";
  EXPECT_EQ(by_units(near, "scans,auc,same,A,B,"), "does not hold");
  EXPECT_EQ(std::get<std::int64_t>(answer(near, "scans,auc,above,A,B,").at("n_shapes")), 40);
  EXPECT_EQ(std::get<std::int64_t>(answer(near, "scans,auc,above,A,B,").at("n")), 20);
}

TEST(Statements, ReversedModelsHaveTheSameCorrectedValue) {
  const ScoreFile file = scores_of(.1, .2);
  const Cell value = answer(file, "scans,auc,above,A,B,").at("signed_rank_p_holm");
  EXPECT_LT(std::get<double>(value), 1);
  EXPECT_EQ(value, answer(file, "scans,auc,above,B,A,").at("signed_rank_p_holm"));
}

TEST(Statements, AModelWithoutScoresLeavesCellsEmpty) {
  const auto cells = answer(scores_of(1, .2), "scans,auc,above,A,C,");
  EXPECT_TRUE(std::isnan(std::get<double>(cells.at("mean_difference"))));
  EXPECT_EQ(std::get<std::string>(cells.at("by_units")), "");
  EXPECT_EQ(std::get<std::string>(cells.at("by_shapes")), "");
}

TEST(Statements, OneRowPerPairAndNoneWithoutScores) {
  const ScoreFile file = scores_of(1, .2);
  TemporaryFolder folder;
  const auto path = folder.write("claims.csv", std::string("# as said\n") + kHead +
                                                   "4,pairs,word,scans,auc,above,A B,C D,\n"
                                                   "4,no such data,word,meshes,auc,above,A,B,\n"
                                                   "4,no such metric,word,scans,nss,above,A,B,\n"
                                                   "4,another kind,word,scans,auc,hardest_class,A,B,\n"
                                                   "4,not about significance,,scans,auc,above,A,B,\n");
  const std::vector<Statement> statements = read_statements(path);
  EXPECT_THAT(statements, SizeIs(3));
  EXPECT_THAT(statements_table(conclude(file.rows, file.metrics, {}, 1), statements).rows, SizeIs(4));
}

TEST(Statements, OneMeshDecidesNothing) {
  TemporaryFolder folder;
  const ScoreFile file = read_scores(folder.write("scores.csv", "item,view,model,auc\n1,0,A,.6\n1,0,B,.5\n"));
  EXPECT_EQ(by_units(file, "scans,auc,above,A,B,"), "");
}

TEST(Statements, BadRowsAreNamed) {
  TemporaryFolder folder;
  const auto refusal = [&](const std::string& row) {
    try {
      read_statements(folder.write("claims.csv", kHead + row));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(refusal("4,it,word,scan,auc,above,A,B,\n"), HasSubstr("claims.csv:2: data set 'scan'"));
  EXPECT_THAT(refusal("4,it,word,scans,auc,same,A,B,-1\n"), HasSubstr("claims.csv:2: margin -1"));
  EXPECT_THAT(refusal("4,it,word,scans,auc,same,A,B,much\n"), HasSubstr("claims.csv:2"));
}

}  // namespace
}  // namespace salbench
