// SPDX-License-Identifier: GPL-3.0-or-later
// What a run leaves behind: the tables, and a cache that makes the next run nothing to do.
#include "pipeline/results/results.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/table.h"
#include "tests/e2e/workspace.h"
#include "tests/support/job_counts.h"

namespace salbench {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

TEST(Results, TheTablesHaveTheDocumentedColumnsAndARowForEverythingScored) {
  const Workspace toy;
  const Outcome run = toy.salbench("run");
  ASSERT_EQ(run.status, 0) << run.err;
  const Table results = read_csv(toy.out() / "results.csv");
  EXPECT_THAT(results.columns, ElementsAre("dataset", "item", "class", "view", "model", "auc", "auc_exact",
                                           "nss", "cc", "lcc", "n_points", "n_picks"));
  EXPECT_THAT(results.rows, SizeIs(JobCounts().of_kind("scores")));
  const Table summary = read_csv(toy.out() / "summary.csv");
  EXPECT_THAT(summary.columns,
              ElementsAre("dataset", "model", "metric", "n", "mean", "sd", "ci95_low", "ci95_high",
                          "bca95_low", "bca95_high", "n_shapes", "n_own_shapes", "own_mean"));
  EXPECT_THAT(summary.rows, SizeIs(2 * toy_config().models.size() * chosen_metrics({}).size()));
  EXPECT_THAT(run.out, HasSubstr("protocol published"));
  for (const std::string& sentence : text_column(read_csv(toy.out() / "leaders.csv"), "sentence"))
    if (sentence.find("AUC") != std::string::npos && sentence.find("LCC") != std::string::npos) {
      EXPECT_THAT(run.out, HasSubstr("\n" + sentence + "\n"));
    }
}

TEST(Results, TheSummaryIsTheMeanOfTheRows) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run").status, 0);
  const Table results = read_csv(toy.out() / "results.csv");
  const std::vector<double> cc = number_column(results, "cc");
  ASSERT_THAT(text_column(results, "model"), ElementsAre("PS", "RS", "PS", "RS"));
  const Table summary = read_csv(toy.out() / "summary.csv");
  const std::vector<double> mean = number_column(summary, "mean"), n = number_column(summary, "n");
  ASSERT_EQ(text_column(summary, "metric")[3], "cc");  // of PS on meshes, the first block
  EXPECT_EQ(n[3], 2);
  EXPECT_NEAR(mean[3], (cc[0] + cc[2]) / 2, 1e-10);
}

TEST(Results, ConclusionsOfAWrittenTableAreThoseOfTheRun) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const Outcome concluded =
      run_process({SALBENCH_PROGRAM, "conclude", toy.out() / "results.csv", "--out", toy / "concluded"});
  ASSERT_EQ(concluded.status, 0) << concluded.err;
  for (const char* table : {"summary.csv", "ranking.csv", "ranking_agreement.csv", "significance.csv",
                            "per_class.csv", "human_share.csv", "compact.csv", "leaders.csv"})
    EXPECT_EQ(read_file(toy / "concluded" / table), read_file(toy.out() / table)) << table;
  EXPECT_EQ(run_process({SALBENCH_PROGRAM, "conclude", toy.out() / "timeline.csv"}).status, 2);
  EXPECT_EQ(run_process({SALBENCH_PROGRAM, "conclude", toy.out() / "results.csv", "--unit", "view"}).status,
            2);
}

TEST(Results, StatementsStandBesideWhatTheScoresSay) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  write_file(
      toy / "said.csv",
      "section,claim,word,dataset,metric,check,a,b,margin\n4,as written,better,meshes,auc,above,PS,RS,\n");
  const Outcome concluded = run_process({SALBENCH_PROGRAM, "conclude", toy.out() / "results.csv",
                                         "--statements", toy / "said.csv", "--out", toy / "concluded"});
  ASSERT_EQ(concluded.status, 0) << concluded.err;
  EXPECT_THAT(text_column(read_csv(toy / "concluded/statements.csv"), "model_b"), ElementsAre("RS"));
}

// Two meshes of four participants, of whom two predict two others at most.
TEST(Results, TablesOfPeopleHaveTheDocumentedColumnsAndRows) {
  const Workspace toy("dataset: {scans: false}\nmodels: {PS: , HS: , RS: }\n");
  ASSERT_EQ(toy.salbench("run").status, 0);
  const auto table = [&](const char* name) { return read_csv(toy.out() / name); };
  const std::size_t n_metrics = chosen_metrics({}).size();

  const Table curves = table("human_curve_by_mesh.csv");
  EXPECT_THAT(curves.columns, ElementsAre("item", "class", "n", "metric", "value", "reliability"));
  EXPECT_THAT(curves.rows, SizeIs(2 * 2 * n_metrics));
  const Table differences = table("human_curve_differences.csv");
  EXPECT_THAT(differences.columns,
              ElementsAre("metric", "from_participants", "to_participants", "n", "n_shapes",
                          "mean_difference", "ci95_low", "ci95_high", "t_p", "ci90_low", "ci90_high"));
  EXPECT_THAT(differences.rows, SizeIs(n_metrics));
  const auto value = number_column(curves, "value");  // of mesh 1: auc of one, ..., of two; then of mesh 2
  EXPECT_NEAR(number_column(differences, "mean_difference")[0],
              (value[n_metrics] - value[0] + value[3 * n_metrics] - value[2 * n_metrics]) / 2, 1e-9);

  const Table equivalents = table("human_equivalents.csv");
  EXPECT_THAT(equivalents.columns, ElementsAre("dataset", "metric", "model", "n", "n_shapes", "largest_group",
                                               "mean", "k", "ci95_low", "ci95_high", "k_bound", "low_bound",
                                               "high_bound", "crossings", "remark"));
  EXPECT_THAT(equivalents.rows, SizeIs(3 * n_metrics));
  EXPECT_THAT(text_column(equivalents, "remark"), Each("no interval: fewer than 6 units"));
  const auto k = number_column(equivalents, "k");
  const auto bounds = text_column(equivalents, "k_bound");
  for (std::size_t row = 0; row < k.size(); ++row)
    EXPECT_EQ(std::isnan(k[row]), bounds[row] == "<1" || bounds[row] == ">2") << row;

  const Table shares = table("human_share.csv");
  EXPECT_THAT(shares.columns, ElementsAre("dataset", "metric", "model", "n", "n_shapes", "mean", "mean_rs",
                                          "mean_hs", "share", "ci95_low", "ci95_high", "remark"));
  EXPECT_THAT(text_column(shares, "model"), Each("PS"));
  EXPECT_THAT(text_column(shares, "remark"), Each(Not("")));
  const Table reliability = table("human_reliability.csv");
  EXPECT_THAT(reliability.columns,
              ElementsAre("metric", "n", "n_shapes", "fewest_participants", "most_participants", "split_half",
                          "mean", "sd", "ci95_low", "ci95_high"));
  EXPECT_THAT(text_column(reliability, "most_participants"), ElementsAre("4"));
}

TEST(Results, ASecondRunComputesNothingAndSaysTheSame) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.computed(), JobCounts().all());
  const std::string results = toy.results(), summary = toy.summary();
  const auto artefacts = toy.artefacts();
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.computed(), 0);
  EXPECT_EQ(toy.results(), results);
  EXPECT_EQ(toy.summary(), summary);
  EXPECT_EQ(toy.artefacts(), artefacts);  // the names carry the files' checksums
}

TEST(Results, OneAndTwoThreadsWriteTheSameBytes) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run", {"--threads", "1"}).status, 0);
  const std::string results = toy.results(), summary = toy.summary();
  const auto contents = toy.contents();
  toy.forget_everything();
  ASSERT_EQ(toy.salbench("run", {"--threads", "2"}).status, 0);
  EXPECT_EQ(toy.results(), results);
  EXPECT_EQ(toy.summary(), summary);
  EXPECT_EQ(toy.contents(), contents);
  EXPECT_THAT(toy.left_over(), IsEmpty());
}

TEST(Results, AnotherFolderAndAnotherCacheChangeNothing) {
  const Workspace here, there;
  ASSERT_EQ(here.salbench("run").status, 0);
  ASSERT_EQ(there.salbench("run").status, 0);
  EXPECT_EQ(here.results(), there.results());
  EXPECT_EQ(here.contents(), there.contents());
}

TEST(Results, SelectedItemsAreTheOnlyOnes) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run", {"--items", "2"}).status, 0);
  EXPECT_THAT(text_column(read_csv(toy.out() / "results.csv"), "item"), ElementsAre("2", "2"));
}

TEST(Results, ScoresOfSimulatedParticipantsSaySo) {
  const Workspace toy("dataset: {participants: simulated, scans: false}\nmodels: {RS: }\n");
  const Outcome run = toy.salbench("run");
  ASSERT_EQ(run.status, 0) << run.err;
  for (const std::string& text : {toy.results(), toy.summary()}) EXPECT_THAT(text, HasSubstr("# SIMULATED"));
  EXPECT_THAT(run.out, HasSubstr("SIMULATED"));
}

}  // namespace
}  // namespace salbench
