// SPDX-License-Identifier: GPL-3.0-or-later
// What human curves say: by mesh, from one number of participants to another, beside models, of the ground
// truth; and which share of human performance a model reaches.
#include "pipeline/results/human_curves.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/rng.h"
#include "stages/stats/paired.h"
#include "tests/support/threads.h"

namespace salbench {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Metrics metrics_named(std::vector<std::string> names) {
  MetricsOptions options;
  options.names = std::move(names);
  return chosen_metrics(options);
}
const Metrics kAuc = metrics_named({"auc"}), kCc = metrics_named({"cc"}), kKl = metrics_named({"kl"});

ResultRow scored(const std::string& item, const std::string& model, double value,
                 const std::string& category = "", const std::string& view = "") {
  return {view.empty() ? "meshes" : "scans", item, category, view, model, Scores{{value}}};
}

MeshCurve curve_of(const std::string& item, const std::vector<double>& values,
                   const std::string& category = "") {
  MeshCurve mesh{item, category, {}};
  for (const double value : values) mesh.curve.push_back(Scores{{value}});
  return mesh;
}

Conclusions concluded(const std::vector<ResultRow>& rows, Observation unit = Observation::mesh,
                      const Metrics& metrics = kAuc) {
  return conclude(rows, metrics, {.unit = unit}, 1);
}

const Cell& cell(const Table& table, std::size_t row, const std::string& column) {
  const auto at = std::ranges::find(table.columns, column) - table.columns.begin();
  return table.rows.at(row).at(static_cast<std::size_t>(at));
}

double number(const Table& table, std::size_t row, const std::string& column) {
  const Cell& found = cell(table, row, column);
  return std::holds_alternative<std::int64_t>(found) ? static_cast<double>(std::get<std::int64_t>(found))
                                                     : std::get<double>(found);
}

std::string text(const Table& table, std::size_t row, const std::string& column) {
  return std::get<std::string>(cell(table, row, column));
}

// Curves that rise from mesh to mesh by another amount, and scores of A, HS and RS on the same meshes. A lies
// between one and two participants; HS is one of them.
struct People {
  std::vector<MeshCurve> curves;
  std::vector<ResultRow> rows;

  explicit People(std::size_t meshes, std::size_t length = 4) {
    Rng rng(1, "people", "");
    for (std::size_t i = 0; i < meshes; ++i) {
      const std::string item = std::to_string(i);
      const double level = .5 + .1 * rng.normal();
      std::vector<double> values;
      for (std::size_t n = 0; n < length; ++n)
        values.push_back(level + .1 * static_cast<double>(n) + .01 * rng.normal());
      curves.push_back(curve_of(item, values));
      rows.push_back(scored(item, "A", level + .06 + .02 * rng.normal()));
      rows.push_back(scored(item, "HS", values[0] + (i % 2 == 0 ? .005 : -.005)));
      rows.push_back(scored(item, "RS", .1 + .01 * rng.normal()));
    }
  }

  Table equivalents(Observation unit = Observation::mesh) const {
    return human_equivalents_table(curves, rows, concluded(rows, unit));
  }
};

TEST(HumanCurveByMesh, HasARowForEachPointOfEachMesh) {
  const Table table = human_curve_by_mesh_table({curve_of("2", {.5, .6}, "cup"), curve_of("1", {.25})}, kCc);
  EXPECT_THAT(table.columns, ElementsAre("item", "class", "n", "metric", "value", "reliability"));
  EXPECT_THAT(table.rows, ElementsAre(ElementsAre(Cell("2"), Cell("cup"), Cell(std::int64_t{1}), Cell("cc"),
                                                  Cell(.5), Cell(2 * .5 / 1.5)),
                                      ElementsAre(Cell("2"), Cell("cup"), Cell(std::int64_t{2}), Cell("cc"),
                                                  Cell(.6), Cell(2 * .6 / 1.6)),
                                      ElementsAre(Cell("1"), Cell(""), Cell(std::int64_t{1}), Cell("cc"),
                                                  Cell(.25), Cell(2 * .25 / 1.25))));
}

TEST(HumanCurveByMesh, HalvesThatDoNotAgreeHaveNoReliabilityAndOtherMetricsNone) {
  EXPECT_EQ(number(human_curve_by_mesh_table({curve_of("1", {-.9})}, kCc), 0, "reliability"), 0);
  EXPECT_TRUE(std::isnan(number(human_curve_by_mesh_table({curve_of("1", {kNone})}, kCc), 0, "reliability")));
  EXPECT_TRUE(std::isnan(number(human_curve_by_mesh_table({curve_of("1", {.5})}, kAuc), 0, "reliability")));
}

// Hard meshes are hard for any number of people: the rise is the same on all, and known well.
TEST(HumanCurveDifferences, ArePairedByMesh) {
  const std::vector<MeshCurve> curves{curve_of("1", {.1, .2, .35}), curve_of("2", {.5, .61, .7}),
                                      curve_of("3", {.9, .99, 1.1})};
  const Table table = human_curve_differences_table(curves, kAuc, Observation::mesh);
  ASSERT_THAT(table.rows, SizeIs(3));  // 1 to 2, 1 to 3, 2 to 3
  const PairedComparison expected = compare_paired(std::vector{.2, .61, .99}, std::vector{.1, .5, .9});
  EXPECT_EQ(number(table, 0, "from_participants"), 1);
  EXPECT_EQ(number(table, 0, "to_participants"), 2);
  EXPECT_EQ(number(table, 0, "n"), 3);
  EXPECT_DOUBLE_EQ(number(table, 0, "mean_difference"), .1);
  EXPECT_EQ(number(table, 0, "ci95_low"), expected.interval.low);
  EXPECT_EQ(number(table, 0, "ci95_high"), expected.interval.high);
  EXPECT_EQ(number(table, 0, "ci90_low"), expected.equivalence_interval.low);
  EXPECT_EQ(number(table, 0, "ci90_high"), expected.equivalence_interval.high);
  EXPECT_EQ(number(table, 0, "t_p"), expected.t_p);
  EXPECT_GT(number(table, 0, "ci95_low"), 0);
}

TEST(HumanCurveDifferences, TakeTheMeshesThatHaveBothNumbers) {
  const std::vector<MeshCurve> curves{curve_of("1", {.1, .2, .4}), curve_of("2", {.5, .9}),
                                      curve_of("3", {.9, kNone, 1.1})};
  const Table table = human_curve_differences_table(curves, kAuc, Observation::mesh);
  EXPECT_EQ(number(table, 0, "n"), 2);
  EXPECT_DOUBLE_EQ(number(table, 0, "mean_difference"), (.1 + .4) / 2);
  EXPECT_EQ(number(table, 1, "n"), 2);
  EXPECT_DOUBLE_EQ(number(table, 1, "mean_difference"), (.3 + .2) / 2);
  EXPECT_EQ(number(table, 2, "n"), 1);
  EXPECT_TRUE(std::isnan(number(table, 2, "ci95_low"))) << "one mesh";
}

TEST(HumanCurveDifferences, OfClassesAreOfTheirMeans) {
  const std::vector<MeshCurve> curves{curve_of("1", {0, 1}, "cup"), curve_of("2", {0, 3}, "cup"),
                                      curve_of("3", {0, 5}, "ant"), curve_of("4", {0, 99})};
  const Table table = human_curve_differences_table(curves, kAuc, Observation::item_class);
  EXPECT_EQ(number(table, 0, "n"), 2);
  EXPECT_EQ(number(table, 0, "n_shapes"), 3);
  EXPECT_EQ(number(table, 0, "mean_difference"), (2. + 5.) / 2);
}

TEST(HumanCurveDifferences, OfTwoParticipantsThereAreNone) {
  EXPECT_THAT(
      human_curve_differences_table({curve_of("1", {.5}), curve_of("2", {.6})}, kAuc, Observation::mesh).rows,
      IsEmpty());
}

TEST(HumanEquivalents, AModelIsWhereTheMeanCurveReachesItsMean) {
  const People people(24);
  const Table table = people.equivalents();
  ASSERT_THAT(table.rows, SizeIs(3));  // A, HS and RS
  EXPECT_EQ(text(table, 0, "model"), "A");
  EXPECT_EQ(number(table, 0, "n"), 24);
  EXPECT_EQ(number(table, 0, "largest_group"), 4);
  EXPECT_NEAR(number(table, 0, "k"), 1.6, .1);
  EXPECT_LT(number(table, 0, "ci95_low"), number(table, 0, "k"));
  EXPECT_GT(number(table, 0, "ci95_high"), number(table, 0, "k"));
  EXPECT_EQ(number(table, 0, "crossings"), 1);
  for (const char* column : {"k_bound", "low_bound", "high_bound", "remark"})
    EXPECT_EQ(text(table, 0, column), "") << column;
  for (const char* column : {"k_bound", "low_bound", "high_bound"})
    EXPECT_EQ(text(table, 2, column), "<1") << "chance, " << column;
  EXPECT_TRUE(std::isnan(number(table, 2, "k")));
}

TEST(HumanEquivalents, BeyondTheCurveThereIsABoundAndNoNumber) {
  People people(10);
  for (ResultRow& row : people.rows)
    if (row.model == "A") row.scores.values = {5};
  const Table table = people.equivalents();
  for (const char* column : {"k", "ci95_low", "ci95_high"})
    EXPECT_TRUE(std::isnan(number(table, 0, column))) << column;
  for (const char* column : {"k_bound", "low_bound", "high_bound"})
    EXPECT_EQ(text(table, 0, column), ">4") << column;
}

TEST(HumanEquivalents, LowerMayBeBetter) {
  People people(24);
  for (ResultRow& row : people.rows) row.scores.values[0] *= -1;
  for (MeshCurve& mesh : people.curves)
    for (Scores& scores : mesh.curve) scores.values[0] *= -1;
  const Table turned = human_equivalents_table(people.curves, people.rows,
                                               concluded(people.rows, Observation::mesh, kKl)),
              table = People(24).equivalents();
  for (const char* column : {"k", "ci95_low", "ci95_high"})
    EXPECT_EQ(number(turned, 0, column), number(table, 0, column)) << column;
  EXPECT_EQ(text(turned, 2, "k_bound"), "<1");
}

// Scores against all participants are others than those against as many: the scale is not of people.
TEST(HumanEquivalents, SayWhereOneParticipantIsNotWorthOne) {
  People people(24);
  EXPECT_EQ(text(people.equivalents(), 0, "remark"), "");
  for (ResultRow& row : people.rows)
    if (row.model == "HS") row.scores.values[0] += .1;  // a second participant's worth
  const Table table = people.equivalents();
  EXPECT_THAT(
      text(table, 0, "remark"),
      testing::MatchesRegex("not a number of people: one participant \\(HS\\) has k [12]\\.[0-9]+ here"));
  EXPECT_EQ(text(table, 1, "remark"), "") << "HS itself";
}

TEST(HumanEquivalents, UseTheCurveAsFarAsHalfOfTheMeshesHaveIt) {
  People people(9);
  for (std::size_t i = 0; i < 3; ++i) people.curves[i].curve.resize(1);
  const Table most = people.equivalents();
  EXPECT_EQ(number(most, 0, "largest_group"), 4);
  EXPECT_EQ(number(most, 0, "n"), 6);
  for (std::size_t i = 3; i < 5; ++i) people.curves[i].curve.resize(2);
  const Table few = people.equivalents();
  EXPECT_EQ(number(few, 0, "largest_group"), 2) << "four of nine have more";
  EXPECT_EQ(number(few, 0, "n"), 6);
}

TEST(HumanEquivalents, FollowTheUnitOfInference) {
  People people(24);
  const auto class_of = [](const std::string& item) {
    return "class " + std::to_string(std::stoi(item) % 8);
  };
  for (ResultRow& row : people.rows) row.category = class_of(row.item);
  for (MeshCurve& mesh : people.curves) mesh.category = class_of(mesh.item);
  const Table by_class = people.equivalents(Observation::item_class), by_mesh = people.equivalents();
  EXPECT_EQ(number(by_class, 0, "n"), 8);
  EXPECT_EQ(number(by_class, 0, "n_shapes"), 24);
  EXPECT_NEAR(number(by_class, 0, "k"), number(by_mesh, 0, "k"), 1e-9) << "classes of equal size";
  EXPECT_NE(number(by_class, 0, "ci95_low"), number(by_mesh, 0, "ci95_low"));
  EXPECT_EQ(to_csv(people.equivalents(Observation::shape)), to_csv(by_mesh)) << "a mesh is a shape";
}

TEST(HumanEquivalents, AReferenceBoundsItsOwnRowAlone) {
  People people(10);
  std::erase_if(people.rows, [](const ResultRow& row) { return row.model == "HS" && row.item == "3"; });
  const Table table = people.equivalents();
  EXPECT_EQ(number(table, 0, "n"), 10);
  EXPECT_EQ(number(table, 1, "n"), 9);
  EXPECT_EQ(number(table, 2, "n"), 10);
}

// Nothing is thrown, no interval has width 0, and what is empty has its remark.
TEST(HumanEquivalents, OfPoorDataHaveRemarks) {
  const auto remark = [](const People& people) { return text(people.equivalents(), 0, "remark"); };
  EXPECT_EQ(remark(People(1)), "no interval: fewer than 6 units");
  EXPECT_EQ(remark(People(5)), "no interval: fewer than 6 units");
  EXPECT_EQ(remark(People(7, 1)), "") << "two participants";
  EXPECT_THAT(People(7).equivalents(Observation::item_class).rows, IsEmpty()) << "no mesh has a class";
  People undefined(8);
  for (ResultRow& row : undefined.rows)
    if (row.model == "A") row.scores.values = {kNone};
  EXPECT_EQ(remark(undefined), "no scores");
  EXPECT_EQ(number(undefined.equivalents(), 0, "n"), 0);
  EXPECT_EQ(number(undefined.equivalents(), 1, "n"), 8) << "HS has scores";
  People elsewhere(8);
  for (MeshCurve& mesh : elsewhere.curves) mesh.item = "other " + mesh.item;
  EXPECT_EQ(remark(elsewhere), "no mesh has a human curve and scores of all models");
  People equal(8);
  for (ResultRow& row : equal.rows) row.scores.values = {.6};
  for (MeshCurve& mesh : equal.curves) mesh.curve = {Scores{{.5}}, Scores{{.7}}};
  EXPECT_EQ(remark(equal), "no interval: the values do not vary");
}

TEST(HumanReliability, IsTheMeanOverTheMeshesByTheirLargestGroups) {
  const Table table = human_reliability_table(
      {curve_of("1", {.2, .5}), curve_of("2", {.2, .3, .6}), curve_of("3", {-.1})}, kCc, Observation::mesh);
  ASSERT_THAT(table.rows, SizeIs(1));
  EXPECT_EQ(number(table, 0, "n"), 3);
  EXPECT_EQ(number(table, 0, "fewest_participants"), 2);
  EXPECT_EQ(number(table, 0, "most_participants"), 6);
  EXPECT_DOUBLE_EQ(number(table, 0, "split_half"), (.5 + .6 - .1) / 3);
  EXPECT_DOUBLE_EQ(number(table, 0, "mean"), (1 / 1.5 + 1.2 / 1.6 + 0) / 3);
  EXPECT_LT(number(table, 0, "ci95_low"), number(table, 0, "ci95_high"));
}

TEST(HumanReliability, TakesThePointsWhereItIsDefined) {
  const Table table =
      human_reliability_table({curve_of("1", {.5, kNone}), curve_of("2", {kNone})}, kCc, Observation::mesh);
  EXPECT_EQ(number(table, 0, "n"), 1);
  EXPECT_EQ(number(table, 0, "most_participants"), 2);
  EXPECT_TRUE(std::isnan(number(table, 0, "ci95_low")));
  EXPECT_THAT(human_reliability_table({curve_of("1", {kNone})}, kCc, Observation::mesh).rows, IsEmpty());
  EXPECT_THAT(human_reliability_table({curve_of("1", {.5})}, kAuc, Observation::mesh).rows, IsEmpty());
}

TEST(HumanShare, IsTheWayFromChanceToPeople) {
  const std::vector<ResultRow> rows = People(24).rows;
  const Table table = human_share_table(concluded(rows));
  ASSERT_THAT(table.rows, SizeIs(1)) << "HS and RS are the scale";
  EXPECT_EQ(text(table, 0, "model"), "A");
  EXPECT_EQ(number(table, 0, "n"), 24);
  EXPECT_DOUBLE_EQ(number(table, 0, "share"),
                   (number(table, 0, "mean") - number(table, 0, "mean_rs")) /
                       (number(table, 0, "mean_hs") - number(table, 0, "mean_rs")));
  EXPECT_GT(number(table, 0, "ci95_low"), 1) << "A is above one participant on every mesh";
  EXPECT_EQ(text(table, 0, "remark"), "");
}

TEST(HumanShare, IsOfTheShapesThatAllHave) {
  std::vector<ResultRow> rows = People(10).rows;
  std::erase_if(rows, [](const ResultRow& row) {
    return (row.model == "HS" && row.item == "3") || (row.model == "RS" && row.item == "4");
  });
  EXPECT_EQ(number(human_share_table(concluded(rows)), 0, "n"), 8);
}

TEST(HumanShare, OfPoorDataHasRemarks) {
  const auto remark = [](const std::vector<ResultRow>& rows, const Metrics& metrics = kAuc) {
    const Table table = human_share_table(concluded(rows, Observation::mesh, metrics));
    for (const char* end : {"ci95_low", "ci95_high"})
      EXPECT_EQ(text(table, 0, "remark").empty(), !std::isnan(number(table, 0, end)));
    return text(table, 0, "remark");
  };
  const auto without = [](const std::string& model) {
    std::vector<ResultRow> rows = People(8).rows;
    std::erase_if(rows, [&](const ResultRow& row) { return row.model == model; });
    return rows;
  };
  EXPECT_EQ(remark(without("HS")), "no scores of HS");
  EXPECT_EQ(remark(without("RS")), "no scores of RS");
  EXPECT_EQ(remark({scored("1", "A", .5, "", "0")}), "no scores of RS");
  EXPECT_EQ(remark(People(1).rows), "one unit: it does not show that HS is better than RS");
  EXPECT_EQ(remark(People(4).rows), "no interval: fewer than 6 units");
  EXPECT_EQ(remark(People(8).rows, kKl), "HS is not clearly better than RS") << "lower is better";
  EXPECT_EQ(remark({scored("1", "A", .5), scored("1", "RS", .5), scored("2", "HS", .5)}),
            "no shape has scores of HS, RS and all models");
  std::vector<ResultRow> undefined = People(8).rows, equal = undefined;
  for (ResultRow& row : undefined)
    if (row.model == "A") row.scores.values = {kNone};
  EXPECT_EQ(remark(undefined), "no scores");
  for (ResultRow& row : equal) row.scores.values = {row.model == "RS" ? 0. : row.model == "HS" ? 1. : .5};
  EXPECT_EQ(remark(equal), "no interval: the shares do not vary");
  EXPECT_EQ(number(human_share_table(concluded(equal)), 0, "share"), .5);
  EXPECT_THAT(human_share_table(concluded({scored("1", "RS", .5), scored("1", "HS", .5)})).rows, IsEmpty());
  EXPECT_THAT(human_share_table(concluded({})).rows, IsEmpty());
}

TEST(HumanTables, AreTheSameOnAnyNumberOfThreads) {
  const People people(12);
  same_on_any_number_of_threads([&] {
    const Conclusions conclusions = concluded(people.rows);
    return to_csv(human_equivalents_table(people.curves, people.rows, conclusions)) +
           to_csv(human_share_table(conclusions)) +
           to_csv(human_curve_differences_table(people.curves, kAuc, Observation::mesh));
  });
}

}  // namespace
}  // namespace salbench
