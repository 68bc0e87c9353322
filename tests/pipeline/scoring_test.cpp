// SPDX-License-Identifier: GPL-3.0-or-later
// Metrics computed for models and for people, and the tables that contain them.

#include "pipeline/results/tables.h"
#include "pipeline/run/results_folder.h"
#include "stages/metrics/metrics.h"
#include "stages/metrics/score.h"
#include "tests/pipeline/runner_fixture.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST_F(RunnerTest, OtherMetricsConcernTheScoresAlone) {
  run();
  const std::string paper_results = results();
  const std::string further = std::string(kToyConfig) + "metrics: [kl, auc, cc_area]\n";
  const auto computed = run(further);
  const JobCounts jobs(further);
  EXPECT_THAT(computed, SizeIs(jobs.of_kind("scores") + jobs.of_kind("score_table")));
  EXPECT_THAT(computed, Each(AnyOf(HasSubstr("scores."), HasSubstr("score_table."))));
  EXPECT_THAT(results(), HasSubstr("model,auc,kl,cc_area,n_points"));
  EXPECT_THAT(run(std::string(kToyConfig) + "metrics: {names: [cc_area, kl, auc]}\n"), IsEmpty())
      << "the order in a file makes no other key";
  EXPECT_THAT(run(std::string(kToyConfig) + "metrics: [lcc, cc, nss, auc_exact, auc]\n"), IsEmpty())
      << "the paper's by name are the default";
  EXPECT_EQ(results(), paper_results);
}

// Readers reject infinite values; a cache filled by an older program may contain them.
TEST(MeanHistograms, LeaveOutItemsWithAnInfiniteValue) {
  const double infinity = kInfinity;
  const Rules rules = make_rules(toy_config());
  const auto mean = [&](std::string_view stage, const std::vector<ValuePtr>& members) {
    JobInputs in;
    in.members = members.size();
    in.member = [&](std::size_t i) { return members[i]; };
    return value_as<Histogram>(*rules[find_rule(rules, kMeshes, stage)].compute(in));
  };
  const ScalarField sound = {0, 0.2, 1}, wide = {-1.7e99, 0, 1.7e99}, endless = {0, -infinity, 1};
  const std::vector<ValuePtr> maps = {held(sound), held(wide), held(endless)};
  EXPECT_EQ(mean("mean_histogram.PS", maps), mean("mean_histogram.PS", {held(sound), held(wide)}));
  const std::vector<ValuePtr> truths = {held(GroundTruth{sound, {}}), held(GroundTruth{endless, {}}),
                                        held(GroundTruth{wide, {}})};
  EXPECT_EQ(mean("reference", truths), mean("mean_histogram.PS", {held(sound), held(wide)}));
}

TEST_F(RunnerTest, EveryMetricIsFiniteOnMeshesAndScansAndForPeople) {
  run("scan: {step_degrees: 1}\nmodels: {PS: , HS: }\nmetrics: all\n");
  EXPECT_THAT(failures(), IsEmpty());
  for (const ResultRow& row : toy_->results()) {
    ASSERT_THAT(row.scores.values, SizeIs(metric_table().size()));
    for (std::size_t m = 0; m < metric_table().size() && row.scores.n_picks > 0; ++m)
      EXPECT_TRUE(std::isfinite(row.value(m)))
          << metric_table()[m].name << " of " << row.item << " " << row.view;
  }
}

TEST_F(RunnerTest, ScoresReadWhatTheirMetricsDo) {
  const auto inputs_of = [&](const std::string& metrics) {
    ToyRun toy(data_.path(), store_, std::string(kToyConfig) + metrics);
    std::vector<std::string> names;
    for (const std::size_t input : toy.rule("scores.PS", kScans).inputs)
      names.push_back(toy.project.rules[input].stage);
    return names;
  };
  EXPECT_THAT(inputs_of(""), ElementsAre("matched.PS", "scan_ground_truth"));
  EXPECT_THAT(inputs_of("metrics: kl\n"), ElementsAre("map.PS", "scan_ground_truth"));
  EXPECT_THAT(inputs_of("metrics: {names: kl, matching: histogram}\n"),
              ElementsAre("matched.PS", "scan_ground_truth"));
  EXPECT_THAT(inputs_of("metrics: [nss, kl]\n"), ElementsAre("matched.PS", "map.PS", "scan_ground_truth"));
  EXPECT_THAT(inputs_of("metrics: ig_centre\n"), ElementsAre("map.PS", "scan_ground_truth", "scan"));
  EXPECT_THAT(inputs_of("metrics: cc_area\n"),
              ElementsAre("matched.PS", "scan_ground_truth", "scan", "surface"));
  EXPECT_THAT(inputs_of("metrics: [kl, cc_area]\n"),
              ElementsAre("matched.PS", "map.PS", "scan_ground_truth", "scan", "surface"));
}

TEST_F(RunnerTest, OnlyMetricsThatNeedItScoreAConstantMap) {
  const auto shapes = [&](const std::string& metrics) {
    run(std::string(kToyConfig) + metrics);
    const std::vector<ResultRow> constant = collect_constant(toy_->state());
    for (const ResultRow& row : toy_->results()) EXPECT_NE(row.model, kConstantMap);
    return constant.size();
  };
  EXPECT_EQ(shapes(""), 0U);
  EXPECT_EQ(shapes("metrics: [nss, ig, auc_top20]\n"), 0U);
  EXPECT_EQ(shapes("metrics: [nss, kl]\n"), jobs_.shapes());
  EXPECT_EQ(shapes("metrics: {names: [kl_pysaliency, ig_centre]}\n"), jobs_.shapes());
}

constexpr const char* kWithPeople = "scan: {step_degrees: 1}\nmodels: {PS: , HS: }\n";

TEST_F(RunnerTest, PeopleAreScoredOnMeshesAlone) {
  const auto computed = run(kWithPeople);
  EXPECT_THAT(failures(), IsEmpty());
  std::vector<std::string> of_people;
  for (const std::string& job : computed)
    if (job.find(".HS@") != std::string::npos) of_people.push_back(job);
  EXPECT_THAT(of_people,
              ElementsAre("curve.HS@1", "curve.HS@2", "score_table.HS@meshes", "scores.HS@1", "scores.HS@2"));
  EXPECT_THAT(results(), AllOf(HasSubstr("\nmeshes,1,human,,HS,"), HasSubstr("\nscans,1,human,0,PS,"),
                               Not(HasSubstr("\nscans,1,human,0,HS,"))));
  EXPECT_THAT(run(kWithPeople), IsEmpty());
}

TEST_F(RunnerTest, ScoresOfPeopleHaveTheirTable) {
  run(kWithPeople);
  const Table table = people_table(toy_->state(), metrics());
  EXPECT_THAT(to_csv(table), StartsWith("item,class,n,auc,auc_exact,nss,cc,lcc\n1,human,1,"));
  ASSERT_THAT(table.rows, SizeIs(4)) << "four participants per mesh: 1 and 2 against as many";
  const Scores two = toy_->value<HumanCurve>("curve.HS", mesh_unit(1)).at(1);
  std::vector<Cell> last = {"2", "human", cell_of(2)};
  for (const char* metric : {"auc", "auc_exact", "nss", "cc", "lcc"}) last.push_back(value_of(two, metric));
  EXPECT_EQ(table.rows[3], last);
  run();
  EXPECT_THAT(people_table(toy_->state(), metrics()).rows, IsEmpty());
}

TEST_F(RunnerTest, TablesOfAnEarlierRunAreNotLeftBehind) {
  TemporaryFolder out;
  const auto run_and_write = [&](const std::string& yaml) {
    run(yaml);
    for (const std::string& name : files_of_conclusions()) out.write(name, "{}");
    for (const char* name : {"folds.csv", "training.csv"}) out.write(name, "of a cross-validation");
    write_scores(out.path(), toy_->state(), toy_->results(), {});
    for (const TableFile& file : table_files(toy_->state(), toy_->results(), {}))
      EXPECT_THAT(names_of_tables(), Contains(file.name));
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(out.path()))
      found.push_back(entry.path().stem());
    return found;
  };
  EXPECT_THAT(run_and_write(kWithPeople),
              UnorderedElementsAre("results", "means", "constant", "people", "mean_histograms_meshes",
                                   "mean_histograms_scans"));
  EXPECT_THAT(run_and_write(kToyConfig + std::string("metrics: {smoothing: [0, 3]}\n")),
              AllOf(Contains("smoothed"), Not(Contains("people"))));
}

TEST_F(RunnerTest, PeopleDoNotApplyToPooledPicks) {
  for (const char* participant : {"1", "2", "3"})
    std::filesystem::remove(data_ / "RawData" / ("2_" + std::string(participant) + ".pid"));
  run(kWithPeople);
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_TRUE(toy_->decision("scores.HS", 0).computed());
  EXPECT_EQ(toy_->decision("scores.HS", 1).reason, Reason::inapplicable);
  EXPECT_THAT(results(), AllOf(HasSubstr("\nmeshes,1,human,,HS,"), HasSubstr("\nmeshes,2,human,,PS,"),
                               Not(HasSubstr("\nmeshes,2,human,,HS,"))));
}

TEST_F(RunnerTest, OfSimulatedPeopleThereMustBeTwoToo) {
  const auto with = [](int participants) {
    return fmt::format(
        "dataset: {{participants: simulated, scans: false}}\nsimulation: {{participants: {}}}\n"
        "models: {{HS: {{draws: 2}}}}\n",
        participants);
  };
  EXPECT_THAT(run(with(2)), Contains("scores.HS@1"));
  EXPECT_THAT(run(with(1)), Not(Contains("scores.HS@1")));  // although there are .pid files of four
  EXPECT_THAT(failures(), IsEmpty());
}

}  // namespace
}  // namespace salbench
