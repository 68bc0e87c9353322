// SPDX-License-Identifier: GPL-3.0-or-later
// Both protocols, all models and a given reference, end to end.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cache/recipes.h"
#include "io/file.h"
#include "io/table.h"
#include "pipeline/rules/models.h"
#include "tests/e2e/workspace.h"
#include "tests/support/cache_files.h"
#include "tests/support/text_column.h"

namespace salbench {
namespace {

using testing::Each;
using testing::HasSubstr;
using testing::IsSupersetOf;

std::vector<std::string> model_names() {
  std::vector<std::string> names;
  for (const ModelRow& row : model_rows()) names.emplace_back(row.name);
  return names;
}

// Item "1" is enough: every stage and model runs on it and on its scans.
std::string results_of(const Workspace& toy, const std::string& protocol) {
  std::string yaml = "protocol: " + protocol + "\nscan: {step_degrees: 2}\nmodels:\n";
  for (const std::string& name : model_names()) yaml += "  " + name + ":\n";
  toy.configure(yaml);
  const Outcome run = toy.salbench("run", {"--items", "1"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("protocol " + protocol));
  EXPECT_THAT(read_file(toy.out() / "run.yaml"), HasSubstr("protocol: " + protocol + "\n"));
  return toy.results();
}

TEST(Protocol, BothRunEveryModelAndDisagree) {
  const Workspace toy;
  const std::string published = results_of(toy, "published"), text = results_of(toy, "text");
  EXPECT_NE(published, text);
  for (const std::string& csv : {published, text}) {
    const Table table = parse_csv(csv, "results.csv");
    EXPECT_THAT(text_column(table, "model"), IsSupersetOf(model_names()));
    EXPECT_THAT(number_column(table, "cc"), Each(testing::AllOf(testing::Ge(-1), testing::Le(1))));
  }
}

TEST(Protocol, AGivenReferenceReplacesTheDataSetsOwn) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string own = toy.results();
  std::string flat = "bin,GS\n", falling = "GS,LS\n";
  for (int i = 0; i < 100; ++i) {
    flat += std::to_string(i) + ",1\n";
    falling += std::to_string(100 - i) + ",0\n";
  }
  const auto run_with = [&](const std::string& csv) {
    const Outcome run = toy.salbench("run", {"--reference", toy.write("reference.csv", csv).string()});
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_THAT(read_file(toy.out() / "run.yaml"), HasSubstr("reference: given"));
    return toy.results();
  };
  const std::string with_flat = run_with(flat), with_falling = run_with(falling);
  EXPECT_NE(with_flat, own);
  EXPECT_NE(with_flat, with_falling);
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.results(), own);
  EXPECT_EQ(toy.computed(), 0);
}

// --- matching by metric ------------------------------------------------------------------------------------

constexpr const char* kPeopleAndModels = "dataset: {scans: false}\nmodels: {PS: , HS: {draws: 2}, RS: }\n";

std::vector<std::vector<double>> columns_of(const std::string& results,
                                            const std::vector<std::string>& names) {
  const Table table = parse_csv(results, "results.csv");
  std::vector<std::vector<double>> columns;
  for (const std::string& name : names) columns.push_back(number_column(table, name));
  return columns;
}

std::string results_with(const Workspace& toy, const std::string& metrics,
                         const std::vector<std::string>& further = {}) {
  toy.configure(kPeopleAndModels + metrics);
  const Outcome run = toy.salbench("run", further);
  EXPECT_EQ(run.status, 0) << run.err;
  return toy.results();
}

TEST(MatchingByMetric, ThePapersMetricsKeepTheirScoresAndTheirKeys) {
  const std::vector<std::string> papers = {"auc", "auc_exact", "nss", "cc", "lcc"};
  const Workspace toy;
  const std::string results = results_with(toy, "");
  const auto contents = toy.contents();
  EXPECT_EQ(columns_of(results_with(toy, "metrics: all\n"), papers), columns_of(results, papers));
  EXPECT_EQ(results_with(toy, "metrics: {matching: histogram}\n"), results);
  EXPECT_EQ(toy.computed(), 0);
  EXPECT_THAT(toy.contents(), testing::IsSupersetOf(contents));
  for (const KnownArtefact& known : artefacts_of(toy.cache()))
    if (known.stage == "scores.PS" &&
        read_artefact(known)->recipe.options.find("matching: ") == std::string::npos)
      return;
  FAIL() << "the paper's scores name a matching in their keys";
}

TEST(MatchingByMetric, TheRecordSaysHowEachMetricReadsItsMapsAndOfWhichVersionItIs) {
  const Workspace toy;
  results_with(toy, "metrics: {names: [nss, kl, sim, cc_area, lcc], matching: {sim: histogram}}\n");
  const std::string record = read_file(toy.out() / "run.yaml");
  for (const std::string line :
       {"nss: {unit: \"standard deviations\", better: higher, matching: histogram, weighting: equal, "
        "version: 1}",
        "kl: {unit: \"nats\", better: lower, matching: none, weighting: equal, version: 3}",
        "sim: {unit: \"1\", better: higher, matching: histogram, weighting: equal, version: 1}",
        "lcc: {unit: \"1\", better: higher, matching: histogram, weighting: equal, version: 1}",
        "cc_area: {unit: \"1\", better: higher, matching: histogram, weighting: area, version: 1}"})
    EXPECT_THAT(record, HasSubstr("  " + line + "\n"));
  EXPECT_THAT(record, HasSubstr("    matching: {sim: histogram}\n"));
}

}  // namespace
}  // namespace salbench
