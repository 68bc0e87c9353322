// SPDX-License-Identifier: GPL-3.0-or-later
// Tables from which conclusions are drawn, besides results.csv.
#include "pipeline/results/tables.h"

#include "pipeline/rules/models.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

Metrics metrics_named(std::vector<std::string> names) {
  MetricsOptions options;
  options.names = std::move(names);
  return chosen_metrics(options);
}

ResultRow scored(const std::string& item, const std::string& view, const std::string& model, double value,
                 const std::string& split = "") {
  return {view.empty() ? "meshes" : "scans", item, "", view, model, {{value}, 9, 2}, {}, split};
}

// A mesh counts once, regardless of its number of scored views.
TEST(Means, AreOverMeshesOfTheMeansOverTheirViews) {
  const std::vector<ResultRow> rows = {scored("7", "0", "A", 0.5),  scored("7", "1", "A", 0.75),
                                       scored("7", "2", "A", kNan), scored("8", "0", "A", 0.25),
                                       scored("8", "0", "B", kNan), scored("9", "", "B", 1)};
  EXPECT_EQ(to_csv(means_table(rows, metrics_named({"nss"}))),
            "dataset,metric,model,n,mean\n"
            "meshes,nss,B,1,1\n"
            "scans,nss,A,2,0.4375\n"
            "scans,nss,B,0,\n");
  EXPECT_EQ(to_csv(means_table({}, metrics_named({"nss"}))), "dataset,metric,model,n,mean\n");
}

TEST(Means, OfEachSplitFollowThoseOfTheWhole) {
  const std::vector<ResultRow> two = {scored("7", "", "A", 1, "train"), scored("8", "", "A", 2, "test"),
                                      scored("9", "0", "A", 3, "test")};
  EXPECT_EQ(to_csv(means_table(two, metrics_named({"nss"}))),
            "dataset,split,metric,model,n,mean\n"
            "meshes,,nss,A,2,1.5\n"
            "meshes,train,nss,A,1,1\n"
            "meshes,test,nss,A,1,2\n"
            "scans,test,nss,A,1,3\n");
}

TEST(RowsOfConstant, HaveTheScoresOfAllShapesOrOfEach) {
  MetricsOptions options;
  options.names = {"auc_exact", "nss", "kl"};
  options.constant_nss = -0.5;
  ResultRow a = {"scans", "7", "cup", "3", "A", {{0.9, 1, 2}, 9, 2}, {0, {kScans, 3}}, "test"};
  ResultRow b = a, other = a, varying = a;
  b.model = "B";
  other.view = "4";
  other.job.unit.index = 4;
  varying.scores.values = {1.25};
  const std::vector<ResultRow> rows = rows_of_constant({a, b, other}, {varying}, options);
  EXPECT_EQ(to_csv(results_table(rows, chosen_metrics(options))),
            "dataset,split,item,class,view,model,auc_exact,nss,kl,n_points,n_picks\n"
            "scans,test,7,cup,3,constant,0.5,-0.5,1.25,9,2\n"
            "scans,test,7,cup,4,constant,0.5,-0.5,,9,2\n");
  EXPECT_TRUE(is_reference_model(kConstantMap)) << "it is no competitor";
}

}  // namespace
}  // namespace salbench
