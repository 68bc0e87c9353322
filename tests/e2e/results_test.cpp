// SPDX-License-Identifier: GPL-3.0-or-later
// What a run leaves behind: the tables, and a cache that makes the next run nothing to do.
#include "pipeline/results/results.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "io/table.h"
#include "stages/metrics/metrics.h"
#include "tests/e2e/workspace.h"
#include "tests/support/job_counts.h"
#include "tests/support/text_column.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
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

TEST(Results, ConclusionsOfAWrittenTableAreThoseOfTheRun) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const Outcome concluded =
      run_process({SALBENCH_PROGRAM, "conclude", toy.out() / "results.csv", "--out", toy / "concluded"});
  ASSERT_EQ(concluded.status, 0) << concluded.err;
  for (const char* table : {"summary.csv", "ranking.csv", "ranking_agreement.csv", "significance.csv",
                            "per_class.csv", "human_share.csv", "compact.csv", "leaders.csv"})
    EXPECT_EQ(read_file(toy / "concluded" / table), read_file(toy.out() / table)) << table;
  EXPECT_EQ(run_process({SALBENCH_PROGRAM, "conclude", toy.out() / "costs.csv"}).status, 2);
  EXPECT_EQ(run_process({SALBENCH_PROGRAM, "conclude", toy.out() / "results.csv", "--unit", "view"}).status,
            2);
}

// Either goes on from the cache of the other.
TEST(Results, AreThoseOfTheEngineWithoutPython) {
  const Workspace toy;
  const auto engine = [&](const char* out) {
    const Outcome run = run_process({SALBENCH_ENGINE, toy.config().string(), toy.data().string(),
                                     toy.cache().string(), (toy / out).string()});
    EXPECT_EQ(run.status, 0) << run.err;
    for (const char* table : {"results.csv", "means.csv"})
      EXPECT_EQ(read_file(toy / out / table), read_file(toy.out() / table)) << table;
  };
  ASSERT_EQ(toy.salbench("run").status, 0);
  const auto contents = toy.contents();
  engine("again");
  EXPECT_THAT(read_file(toy / "again/run.yaml"), HasSubstr("\nartefacts_computed: 0\n"));
  fs::remove_all(toy.cache());
  engine("anew");
  EXPECT_EQ(toy.contents(), contents);
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.computed(), 0U);
}

TEST(Results, ScoresOfSimulatedParticipantsSaySo) {
  const Workspace toy("dataset: {participants: simulated, scans: false}\nmodels: {RS: }\n");
  const Outcome run = toy.salbench("run");
  ASSERT_EQ(run.status, 0) << run.err;
  for (const char* table :
       {"results.csv", "summary.csv", "means.csv", "constant.csv", "mean_histograms_meshes.csv"})
    EXPECT_THAT(read_csv(toy.out() / table).remarks, testing::ElementsAre(testing::StartsWith("SIMULATED")))
        << table;
  EXPECT_THAT(run.out, HasSubstr("SIMULATED"));
}

}  // namespace
}  // namespace salbench
