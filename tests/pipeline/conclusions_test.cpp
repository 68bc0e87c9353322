// SPDX-License-Identifier: GPL-3.0-or-later
// What counts as one observation, which shapes models are compared on, and what the tables say of them.
#include "pipeline/results/conclusions.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/rng.h"
#include "stages/stats/summary.h"
#include "tests/support/threads.h"

namespace salbench {
namespace {

using testing::ElementsAre;
using testing::Not;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
const Metrics kAuc = [] {
  MetricsOptions options;
  options.names = {"auc"};
  return chosen_metrics(options);
}();

ResultRow scored(const std::string& item, const std::string& view, const std::string& model, double auc,
                 const std::string& category = "") {
  return {view.empty() ? "meshes" : "scans", item, category, view, model, Scores{{auc}}};
}

Conclusions concluded(const std::vector<ResultRow>& rows, Observation unit = Observation::mesh) {
  return conclude(rows, kAuc, {.unit = unit}, 1);
}

// The cell of a column in the only row that has these cells.
Cell cell(const Table& table, const std::string& column, const std::vector<std::string>& words) {
  const auto at = std::ranges::find(table.columns, column) - table.columns.begin();
  for (const std::vector<Cell>& row : table.rows)
    if (std::ranges::all_of(words, [&](const Cell& word) { return std::ranges::count(row, word) > 0; }))
      return row.at(static_cast<std::size_t>(at));
  return "no such row";
}

double number(const Table& table, const std::string& column, const std::vector<std::string>& words) {
  const Cell found = cell(table, column, words);
  return std::holds_alternative<std::int64_t>(found) ? static_cast<double>(std::get<std::int64_t>(found))
                                                     : std::get<double>(found);
}

// Meshes that differ much and views that differ little, two models that differ in nothing but noise.
std::vector<ResultRow> scans_of(std::size_t meshes, double between, double within) {
  Rng rng(1, "conclusions", "");
  std::vector<ResultRow> rows;
  for (std::size_t mesh = 0; mesh < meshes; ++mesh) {
    const double a = between * rng.normal(), b = between * rng.normal();
    for (int view = 0; view < 12; ++view) {
      rows.push_back(scored(std::to_string(mesh), std::to_string(view), "A", a + within * rng.normal()));
      rows.push_back(scored(std::to_string(mesh), std::to_string(view), "B", b + within * rng.normal()));
    }
  }
  return rows;
}

TEST(Units, TheViewsOfAMeshAreOneObservation) {
  const std::vector<ResultRow> rows = scans_of(10, 1, 0.1);
  const Table by_mesh = significance_table(concluded(rows)),
              by_shape = significance_table(concluded(rows, Observation::shape));
  EXPECT_EQ(number(by_mesh, "n", {"A", "B"}), 10);
  EXPECT_EQ(number(by_shape, "n", {"A", "B"}), 120);
  EXPECT_EQ(number(by_mesh, "n_shapes", {"A", "B"}), 120);
  EXPECT_NEAR(number(by_mesh, "mean_difference", {"A", "B"}), number(by_shape, "mean_difference", {"A", "B"}),
              1e-12);
  const auto width = [](const Table& table) {
    return number(table, "ci95_high", {"A", "B"}) - number(table, "ci95_low", {"A", "B"});
  };
  EXPECT_GT(width(by_mesh), 3 * width(by_shape));  // sqrt(12) if views of a mesh were equal
  EXPECT_EQ(number(by_mesh, "rank_sum_p", {"A", "B"}), number(by_shape, "rank_sum_p", {"A", "B"}))
      << "the paper's test takes shapes, whatever the unit";
}

TEST(Units, AClassIsOneObservationAndShapesWithoutOneAreNone) {
  const std::vector<ResultRow> rows{scored("1", "", "A", 1, "human"), scored("2", "", "A", 2, "human"),
                                    scored("3", "", "A", 5, "cup"), scored("4", "", "A", 99)};
  const Table summary = summary_table(concluded(rows, Observation::item_class));
  EXPECT_EQ(number(summary, "n", {"A"}), 2);
  EXPECT_EQ(number(summary, "n_shapes", {"A"}), 3);
  EXPECT_EQ(number(summary, "mean", {"A"}), (1.5 + 5) / 2);
}

TEST(Units, AViewWithoutAScoreLeavesTheOthersOfItsMesh) {
  const std::vector<ResultRow> rows{scored("1", "0", "A", 1), scored("1", "1", "A", kNone),
                                    scored("1", "2", "A", 3), scored("2", "0", "A", kNone)};
  const Table summary = summary_table(concluded(rows));
  EXPECT_EQ(number(summary, "n", {"A"}), 1);
  EXPECT_EQ(number(summary, "n_shapes", {"A"}), 2);
  EXPECT_EQ(number(summary, "mean", {"A"}), 2);
}

// A fails on the hardest shape, and must not rise by that.
TEST(ComparedShapes, AreThoseThatAllCompetitorsHaveAScoreFor) {
  const std::vector<ResultRow> rows{scored("1", "", "A", .8),    scored("1", "", "B", .9),
                                    scored("2", "", "A", .6),    scored("2", "", "B", .7),
                                    scored("3", "", "A", kNone), scored("3", "", "B", .1)};
  const Table summary = summary_table(concluded(rows));
  EXPECT_NEAR(number(summary, "mean", {"A"}), .7, 1e-12);
  EXPECT_NEAR(number(summary, "mean", {"B"}), .8, 1e-12);
  EXPECT_EQ(number(summary, "n", {"B"}), 2);
  EXPECT_EQ(number(summary, "n_own_shapes", {"A"}), 2);
  EXPECT_EQ(number(summary, "n_own_shapes", {"B"}), 3);
  EXPECT_NEAR(number(summary, "own_mean", {"B"}), 1.7 / 3, 1e-12);
}

TEST(ComparedShapes, AReferenceBoundsItsOwnRowAlone) {
  const std::vector<ResultRow> rows{scored("1", "", "A", .8), scored("1", "", "HS", .9),
                                    scored("2", "", "A", .6), scored("2", "", "HS", kNone)};
  const Table summary = summary_table(concluded(rows));
  EXPECT_EQ(number(summary, "n", {"A"}), 2);
  EXPECT_EQ(number(summary, "n", {"HS"}), 1);
  EXPECT_EQ(number(significance_table(concluded(rows)), "n", {"A", "HS"}), 1);
}

TEST(RankingTable, HasTheCompetitorsByRankAndNoReference) {
  std::vector<ResultRow> rows;
  for (int item = 0; item < 12; ++item)
    for (const auto& [model, mean] : {std::pair("A", .5), {"B", .7}, {"HS", .9}, {"RS", .1}})
      rows.push_back(
          scored(std::to_string(item), "", model, mean + .01 * (item % (model[0] == 'A' ? 3 : 4))));
  const Table ranking = ranking_table(concluded(rows));
  ASSERT_EQ(ranking.rows.size(), 2U);
  EXPECT_EQ(ranking.rows[0][2], Cell("B"));
  EXPECT_EQ(cell(ranking, "rank_high", {"B"}), Cell(std::int64_t{1}));
  EXPECT_EQ(cell(ranking, "group", {"A"}), Cell("b"));
  EXPECT_EQ(number(ranking, "first", {"B"}), 1);
}

TEST(RankingTable, OfOneMeshHasRanksWithoutIntervals) {
  const Table ranking = ranking_table(concluded({scored("1", "", "A", .5), scored("1", "", "B", .6)}));
  EXPECT_EQ(number(ranking, "rank", {"B"}), 1);
  EXPECT_EQ(cell(ranking, "rank_low", {"B"}), Cell(""));
  EXPECT_TRUE(std::isnan(number(ranking, "first", {"B"})));
}

// Scores that nothing can be said of: no interval has width 0, and nothing is thrown.
TEST(Conclusions, OfPoorDataHaveEmptyCells) {
  const std::vector<std::vector<ResultRow>> poor{
      {scored("1", "", "A", .5)},
      {scored("1", "0", "A", .5), scored("1", "0", "B", .6)},
      {scored("1", "", "A", .5), scored("2", "", "A", .5), scored("1", "", "B", .5),
       scored("2", "", "B", .5)},
      {scored("1", "", "A", kNone), scored("2", "", "A", kNone), scored("1", "", "B", .5)},
      {scored("1", "0", "A", .5), scored("2", "0", "A", .4), scored("2", "1", "A", .3)},
      {scored("1", "", "RS", .5, "cup"), scored("2", "", "RS", .4, "cup")},  // no competitor
      {},
  };
  for (const std::vector<ResultRow>& rows : poor)
    for (const Observation unit : {Observation::mesh, Observation::item_class, Observation::shape}) {
      const Conclusions conclusions = concluded(rows, unit);
      for (const Table& table :
           {summary_table(conclusions), significance_table(conclusions), ranking_table(conclusions),
            agreement_table(conclusions), overview_table(conclusions)})
        for (const std::vector<Cell>& row : table.rows) {
          ASSERT_EQ(row.size(), table.columns.size());
          const auto low = std::ranges::find(table.columns, "ci95_low") - table.columns.begin();
          if (static_cast<std::size_t>(low) == table.columns.size()) continue;
          const auto end = [&](std::ptrdiff_t at) {
            return std::get<double>(row[static_cast<std::size_t>(at)]);
          };
          EXPECT_FALSE(end(low) == end(low + 1)) << to_csv(table);
        }
    }
}

TEST(Conclusions, AreTheSameOnAnyNumberOfThreads) {
  const std::vector<ResultRow> rows = scans_of(8, 1, 1);
  same_on_any_number_of_threads([&] {
    const Conclusions conclusions = concluded(rows);
    return to_csv(summary_table(conclusions)) + to_csv(ranking_table(conclusions)) +
           to_csv(significance_table(conclusions)) + to_csv(agreement_table(conclusions));
  });
}

// Two metrics over different meshes: compared over those that both have.
TEST(AgreementTable, TakesTheUnitsThatBothMetricsHave) {
  MetricsOptions options;
  options.names = {"auc", "nss", "kl"};
  const Metrics metrics = chosen_metrics(options);  // kl: lower is better
  std::vector<ResultRow> rows;
  for (int item = 0; item < 6; ++item)
    for (const double model : {1.0, 2.0, 3.0}) {
      ResultRow row = scored(std::to_string(item), "", "M" + std::to_string(static_cast<int>(model)), model);
      row.scores.values = {model + .01 * item, item == 0 ? kNone : 2 * model, -model};
      rows.push_back(row);
    }
  const Table table = agreement_table(conclude(rows, metrics, {}, 1));
  EXPECT_EQ(number(table, "n", {"auc", "nss"}), 5);
  EXPECT_EQ(number(table, "n", {"auc", "kl"}), 6);
  for (const std::vector<std::string>& pair :
       {std::vector<std::string>{"auc", "nss"}, {"auc", "kl"}, {"nss", "kl"}})
    EXPECT_EQ(number(table, "tau", pair), 1) << pair[1];
}

// The average's interval is over shapes: models that agree on each shape make it no narrower.
TEST(PerClassTable, AveragesCompetitorsShapeByShape) {
  const std::vector<ResultRow> rows{scored("1", "0", "A", .2, "cup"),  scored("1", "1", "A", .4, "cup"),
                                    scored("2", "0", "A", .6, "cup"),  scored("1", "0", "B", .2, "cup"),
                                    scored("1", "1", "B", .4, "cup"),  scored("2", "0", "B", .6, "cup"),
                                    scored("1", "0", "RS", .9, "cup"), scored("2", "0", "RS", .9, "cup")};
  const Table table = per_class_table(rows, kAuc, Observation::mesh);
  EXPECT_EQ(number(table, "n", {"A"}), 2);
  EXPECT_NEAR(number(table, "mean", {"A"}), (.3 + .6) / 2, 1e-12);
  for (const char* column : {"n", "n_shapes", "mean", "ci95_low", "ci95_high"})
    EXPECT_DOUBLE_EQ(number(table, column, {"Avg"}), number(table, column, {"A"})) << column;
  EXPECT_NEAR(number(per_class_table(rows, kAuc, Observation::shape), "mean", {"A"}), .4, 1e-12);
}

}  // namespace
}  // namespace salbench
