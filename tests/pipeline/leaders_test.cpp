// SPDX-License-Identifier: GPL-3.0-or-later
// Sentences on who leads say what the intervals of the ranks allow and no more; compact intervals stay within
// the range of their metric.
#include "pipeline/results/leaders.h"

#include <cmath>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/results/compact.h"
#include "stages/core/rng.h"
#include "stages/metrics/range.h"

namespace salbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kNoScore = std::numeric_limits<double>::quiet_NaN();

Metrics metrics_named(const std::vector<std::string>& names) {
  MetricsOptions options;
  options.names = names;
  return chosen_metrics(options);
}

using Level = std::vector<std::pair<std::string, double>>;  // model and its mean, all scores near it

// Scores of meshes that differ much between meshes and little between models, by one metric.
std::vector<ResultRow> scored(const Level& models, std::size_t meshes, double noise = 0.01,
                              const std::string& split = "") {
  Rng rng(7, "leaders", "");
  std::vector<ResultRow> rows;
  for (std::size_t mesh = 0; mesh < meshes; ++mesh) {
    const double of_mesh = 0.05 * rng.normal();
    for (const auto& [model, mean] : models) {
      rows.push_back({"meshes", split + std::to_string(mesh), "", "", model,
                      Scores{{mean + of_mesh + noise * rng.normal()}}});
      rows.back().split = split;
    }
  }
  return rows;
}

std::vector<LevelLeaders> found(const std::vector<ResultRow>& rows, const Metrics& metrics,
                                Conclusions& conclusions) {
  conclusions = conclude(rows, metrics, {}, 1);
  return find_leaders(conclusions);
}

LevelLeaders only(const std::vector<ResultRow>& rows, const Metrics& metrics = metrics_named({"auc"})) {
  static Conclusions conclusions;
  const std::vector<LevelLeaders> levels = found(rows, metrics, conclusions);
  EXPECT_THAT(levels, SizeIs(1));
  return levels.at(0);
}

// Column of a table by name.
std::vector<Cell> column(const Table& table, const std::string& name) {
  const auto at = std::ranges::find(table.columns, name) - table.columns.begin();
  std::vector<Cell> cells;
  for (const std::vector<Cell>& row : table.rows) cells.push_back(row.at(static_cast<std::size_t>(at)));
  return cells;
}

TEST(Leaders, OneThatIsAheadOfAllLeads) {
  const LevelLeaders level = only(scored({{"A", 0.6}, {"B", 0.5}, {"C", 0.45}}, 20));
  const Leader& leader = level.metrics.at(0);
  EXPECT_EQ(leader.verdict, Lead::leads);
  EXPECT_THAT(leader.models, ElementsAre("A"));
  EXPECT_EQ(leader.second, "B");
  EXPECT_GT(leader.lead_interval.low, 0);
  EXPECT_NEAR(leader.lead, 0.1, 0.02);
  EXPECT_THAT(level.sentence, testing::StartsWith("On 20 meshes, A leads by AUC (mean 0."));
  EXPECT_THAT(level.sentence, HasSubstr(", 95 % interval 0."));
}

TEST(Leaders, EqualModelsCannotBeToldApart) {
  const LevelLeaders level = only(scored({{"A", 0.5}, {"B", 0.5}, {"C", 0.2}}, 20));
  const Leader& leader = level.metrics.at(0);
  EXPECT_EQ(leader.verdict, Lead::not_apart);
  EXPECT_THAT(leader.models, testing::UnorderedElementsAre("A", "B"));
  EXPECT_LT(leader.lead_interval.low, 0);
  EXPECT_THAT(level.sentence, HasSubstr("cannot be told apart"));
  EXPECT_THAT(level.sentence, testing::Not(HasSubstr("leads")));
  EXPECT_THAT(level.sentence, testing::Not(HasSubstr(" C ")));
}

// A is ahead of B, which varies little beside it, but not of C, which varies much.
TEST(Leaders, ANoisyModelKeepsTheBestOneFromLeading) {
  Rng rng(3, "noisy", "");
  std::vector<ResultRow> rows;
  for (int mesh = 0; mesh < 12; ++mesh) {
    const std::string item = std::to_string(mesh);
    rows.push_back({"meshes", item, "", "", "A", Scores{{0.6 + 0.001 * rng.normal()}}});
    rows.push_back({"meshes", item, "", "", "B", Scores{{0.55 + 0.001 * rng.normal()}}});
    rows.push_back({"meshes", item, "", "", "C", Scores{{0.5 + 0.4 * (mesh % 2 == 0 ? 1 : -1)}}});
  }
  const LevelLeaders level = only(rows);
  EXPECT_NE(level.metrics.at(0).verdict, Lead::leads);
  EXPECT_THAT(level.sentence, HasSubstr("cannot be told apart"));
  EXPECT_THAT(level.sentence, HasSubstr("C"));
}

TEST(Leaders, AMetricWhereLowerIsBetterIsLedByTheLowest) {
  const LevelLeaders level = only(scored({{"A", 0.6}, {"B", 0.5}}, 20), metrics_named({"mse"}));
  EXPECT_THAT(level.metrics.at(0).models, ElementsAre("B"));
  EXPECT_GT(level.metrics.at(0).lead, 0);
  EXPECT_GT(level.metrics.at(0).lead_interval.low, 0);
}

TEST(Leaders, ReferencesAreNoCandidates) {
  const LevelLeaders level = only(scored({{"HS", 0.9}, {"A", 0.6}, {"B", 0.5}, {"RS", 0.8}}, 20));
  EXPECT_THAT(level.metrics.at(0).models, ElementsAre("A"));
  EXPECT_EQ(level.metrics.at(0).n_models, 2U);
  const LevelLeaders alone = only(scored({{"HS", 0.9}, {"RS", 0.5}}, 20));
  EXPECT_THAT(alone.metrics, IsEmpty());
  EXPECT_EQ(alone.sentence, "On meshes, no model has scores but references.");
}

TEST(Leaders, OneMeshOneModelAndNoCommonShapeAreSaid) {
  EXPECT_EQ(only(scored({{"A", 0.6}, {"B", 0.5}}, 1)).sentence,
            "On 1 mesh, one observation does not tell how the models rank by AUC.");
  EXPECT_THAT(only(scored({{"A", 0.6}}, 5)).sentence,
              HasSubstr("A is the only model that is scored by AUC (mean"));
  const std::vector<ResultRow> apart = {{"meshes", "1", "", "", "A", Scores{{0.5}}},
                                        {"meshes", "2", "", "", "B", Scores{{0.6}}}};
  EXPECT_EQ(only(apart).sentence, "On meshes, no shape has scores of all models by AUC.");
}

TEST(Leaders, MetricsThatSayTheSameShareAClause) {
  std::vector<ResultRow> rows = scored({{"A", 0.6}, {"B", 0.5}}, 20);
  for (ResultRow& row : rows) row.scores.values = {row.scores.values[0], row.scores.values[0], 0.5};
  const LevelLeaders level = only(rows, metrics_named({"auc", "nss", "lcc"}));
  EXPECT_THAT(level.sentence, testing::ContainsRegex("A leads by AUC \\(mean [0-9., a-z%]*\\) and NSS \\(0"));
  EXPECT_THAT(level.sentence, HasSubstr("; by LCC ("));
  EXPECT_THAT(level.sentence, HasSubstr("0.500, no interval"));
}

TEST(Leaders, ViewsAreCountedBesideTheirMeshes) {
  std::vector<ResultRow> rows;
  for (ResultRow row : scored({{"A", 0.6}, {"B", 0.5}}, 20)) {
    row.dataset = "scans";
    for (const char* view : {"0", "1"}) {
      row.view = view;
      rows.push_back(row);
    }
  }
  EXPECT_THAT(only(rows).sentence, testing::StartsWith("On 40 scans of 20 meshes, A leads"));
}

TEST(Leaders, EachSplitHasASentenceOfItsOwn) {
  std::vector<ResultRow> rows = scored({{"A", 0.6}, {"B", 0.5}}, 10, 0.01, "train");
  for (const ResultRow& row : scored({{"A", 0.5}, {"B", 0.6}}, 10, 0.01, "test")) rows.push_back(row);
  const Metrics metrics = metrics_named({"auc"});
  Conclusions conclusions;
  const std::vector<LevelLeaders> levels = found(rows, metrics, conclusions);
  ASSERT_THAT(levels, SizeIs(3));
  EXPECT_THAT(levels[1].sentence, testing::StartsWith("On 10 meshes of split train, A leads"));
  EXPECT_THAT(levels[2].sentence, testing::StartsWith("On 10 meshes of split test, B leads"));
  const Table table = leaders_table(conclusions, levels);
  EXPECT_THAT(column(table, "split"),
              ElementsAre(Cell(""), Cell(""), Cell("train"), Cell("train"), Cell("test"), Cell("test")));
}

TEST(Leaders, TheTableHasTheSentenceAndARowPerMetric) {
  const std::vector<ResultRow> rows = scored({{"A", 0.6}, {"B", 0.5}}, 20);
  const Conclusions conclusions = conclude(rows, metrics_named({"auc"}), {}, 1);
  const std::vector<LevelLeaders> levels = find_leaders(conclusions);
  const Table table = leaders_table(conclusions, levels);
  EXPECT_THAT(column(table, "metric"), ElementsAre(Cell(""), Cell("auc")));
  EXPECT_THAT(column(table, "verdict"), ElementsAre(Cell(""), Cell("leads")));
  EXPECT_THAT(column(table, "sentence"), ElementsAre(Cell(levels[0].sentence), Cell(levels[0].sentence)));
}

TEST(Leaders, LongListsAreCutAndLeadingMetricsAreThePapers) {
  Level models;
  for (char name = 'A'; name < 'M'; ++name) models.emplace_back(std::string(1, name), 0.5);
  EXPECT_THAT(only(scored(models, 20)).sentence, HasSubstr("and 8 others cannot be told apart"));
  EXPECT_THAT(leading_metrics(metrics_named({"lcc", "kl", "auc", "sim", "mse"})),
              ElementsAre("auc", "lcc", "kl"));
}

// Over many made-up data sets: a model leads only if it is ahead of each other one by the joint interval.
TEST(Leaders, NoSentenceClaimsMoreThanItsInterval) {
  std::map<Lead, int> seen;
  for (int trial = 0; trial < 60; ++trial) {
    const double apart = 0.0004 * trial;
    const LevelLeaders level = only(scored({{"A", 0.5 + apart}, {"B", 0.5}, {"C", 0.5 - apart}}, 8));
    const Leader& leader = level.metrics.at(0);
    ++seen[leader.verdict];
    const bool says_leads = level.sentence.find(" leads ") != std::string::npos;
    EXPECT_EQ(says_leads, leader.verdict == Lead::leads);
    EXPECT_TRUE(leader.lead_interval.low > 0 || !says_leads) << level.sentence;
  }
  EXPECT_GT(seen[Lead::leads], 0);
  EXPECT_GT(seen[Lead::not_apart], 0);
}

TEST(Compact, IntervalsStayWithinTheRangeOfTheMetric) {
  const std::vector<ResultRow> rows = scored({{"A", 0.99}, {"B", 0.5}}, 3, 0.002);
  const Conclusions conclusions = conclude(rows, metrics_named({"auc"}), {}, 1);
  const Table table = compact_table(conclusions);
  const auto high = column(table, "high"), half = column(table, "half"), mean = column(table, "mean");
  ASSERT_THAT(table.rows, SizeIs(2));
  EXPECT_EQ(std::get<double>(high[0]), std::max(1.0, std::get<double>(mean[0])));
  EXPECT_TRUE(std::isnan(std::get<double>(half[0])));  // not the same on both sides
  EXPECT_LT(std::get<double>(high[1]), 1);
  EXPECT_NEAR(std::get<double>(half[1]), std::get<double>(high[1]) - std::get<double>(mean[1]), 1e-12);
  const Table whole = summary_table(conclusions);
  EXPECT_GT(std::get<double>(column(whole, "ci95_high")[0]), 1);  // the older table is as it was
}

TEST(Compact, AModelThatFailedIsComparedOnTheCommonShapesAndCounted) {
  std::vector<ResultRow> rows = scored({{"A", 0.6}, {"B", 0.5}, {"HS", 0.7}}, 10);
  rows[0].scores.values[0] = kNoScore;  // A on the first mesh
  const Table table = compact_table(conclude(rows, metrics_named({"auc"}), {}, 1));
  EXPECT_THAT(column(table, "model"), ElementsAre(Cell("A"), Cell("B"), Cell("HS")));
  EXPECT_THAT(column(table, "kind"), ElementsAre(Cell("model"), Cell("model"), Cell("reference")));
  const auto count = [](std::int64_t n) { return Cell(n); };
  EXPECT_THAT(column(table, "n_missing"), ElementsAre(count(1), count(0), count(0)));
  EXPECT_THAT(column(table, "n_shapes"), ElementsAre(count(9), count(9), count(9)));
  EXPECT_THAT(column(table, "best"), ElementsAre(count(1), count(0), count(0)));
  EXPECT_EQ(column(table, "rank")[2], Cell(""));
}

TEST(Range, EveryMetricWithoutAUnitIsBounded) {
  for (const Metric& metric : metric_table()) {
    const Range range = range_of(metric.name);
    EXPECT_LT(range.low, range.high) << metric.name;
    EXPECT_EQ(std::isfinite(range.low) && std::isfinite(range.high), metric.unit == "1") << metric.name;
  }
  EXPECT_EQ(range_of("kl_area").low, 0);
  EXPECT_EQ(range_of("cc").low, -1);
  EXPECT_TRUE(std::isinf(range_of("auc_of_somebody").high));  // anybody's column: nothing is known of it
}

}  // namespace
}  // namespace salbench
