// SPDX-License-Identifier: GPL-3.0-or-later
// What a run computes, counted: the engine's promise is that it is exactly what is missing.
#include "pipeline/run/runner.h"

#include <map>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/results/results.h"
#include "pipeline/results/statistics.h"
#include "tests/support/job_counts.h"
#include "tests/support/meeting.h"
#include "tests/support/memory_store.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

class RunnerTest : public testing::Test {
 protected:
  void SetUp() override {
    write_toy_item(data_.path(), "1", shapes::bumpy_sphere(2));
    write_toy_item(data_.path(), "2", shapes::bumpy_sphere(2, 0.35));
  }

  // Runs and returns "stage@item" of all that was computed.
  std::vector<std::string> run(const std::string& yaml = kToyConfig, int threads = 2) {
    ToyRun toy(data_.path(), store_, yaml);
    toy.run(threads);
    for (const Failure& failure : toy.runner.failures())
      failures_.push_back(toy.context.name(failure.job) + ": " + toy.context.row(failure.job).name + ": " +
                          failure.cause);
    results_ = to_csv(results_table(toy.results(), chosen_metrics(toy.config.metrics)));
    return store_.take_saved();
  }

  const JobCounts jobs_;  // of a first run over both meshes
  TemporaryFolder data_;
  MemoryStore store_;
  std::vector<std::string> failures_;
  std::string results_;
};

TEST_F(RunnerTest, AFirstRunComputesEverythingAndASecondNothing) {
  EXPECT_THAT(run(), SizeIs(jobs_.all()));
  EXPECT_THAT(failures_, IsEmpty());
  const std::string first = results_;
  EXPECT_THAT(run(), IsEmpty());
  EXPECT_EQ(results_, first);
}

TEST_F(RunnerTest, ThePlanForesaysWhatIsDone) {
  ToyRun first(data_.path(), store_);
  EXPECT_EQ(first.open(), jobs_.of_shapes());
  first.run();
  EXPECT_EQ(first.count(Verdict::done), jobs_.of_shapes());
  ToyRun second(data_.path(), store_);
  EXPECT_EQ(second.open(), 0U);
  EXPECT_EQ(second.count(Verdict::cached), jobs_.of_shapes());
}

TEST_F(RunnerTest, ResultsDoNotDependOnThreads) {
  run(kToyConfig, 1);
  const std::string one = results_;
  store_.clear();
  run(kToyConfig, 4);
  EXPECT_EQ(results_, one);
}

// Does something before what the stage does anyway.
using Before = std::function<void(const JobInputs&)>;
void do_before(Row& row, const Before& before) {
  row.run = [before, was = row.run](const JobInputs& in) {
    before(in);
    return was(in);
  };
}

TEST_F(RunnerTest, WithTwoThreadsTwoMeshesAreWorkedOnAtTheSameTime) {
  ToyRun toy(data_.path(), store_);
  Meeting both(2);
  do_before(toy.catalog.rows[toy.row("normals")], [&](const JobInputs&) { EXPECT_TRUE(both.join()); });
  toy.run(2);
  EXPECT_TRUE(both.met());
}

TEST_F(RunnerTest, WithTwoThreadsTwoScansOfAMeshAreWorkedOnAtTheSameTime) {
  ToyRun toy(data_.path(), store_, kToyConfig, "1");
  Meeting both(2);
  do_before(toy.catalog.rows[toy.row("scan_normals", Shapes::scans)], [&](const JobInputs& in) {
    if (in.view == 3 || in.view == 7) {
      EXPECT_TRUE(both.join());
    }
  });
  toy.run(2);
  EXPECT_TRUE(both.met());
}

TEST_F(RunnerTest, WithTwoThreadsTwoModelsOfOneShapeRunAtTheSameTime) {
  ToyRun toy(data_.path(), store_, kToyConfig, "1");
  Meeting both(2);
  for (const char* model : {"map.PS", "map.RS"})
    do_before(toy.catalog.rows[toy.row(model)], [&](const JobInputs&) { EXPECT_TRUE(both.join()); });
  toy.run(2);
  EXPECT_TRUE(both.met());
}

TEST_F(RunnerTest, EveryComputedArtefactPassedThroughTheNodeOfItsRow) {
  ToyRun toy(data_.path(), store_);
  toy.run();
  std::map<std::string, std::size_t> computed, saved;
  for (std::size_t row = 0; row < toy.catalog.rows.size(); ++row) {
    const NodeRecord& node = toy.runner.records()[row];
    EXPECT_EQ(node.settled, toy.plan.jobs[row].size()) << toy.catalog.rows[row].name;
    computed[toy.catalog.rows[row].name] += node.seconds.size();
  }
  for (const std::string& artefact : store_.take_saved()) ++saved[artefact.substr(0, artefact.find('@'))];
  EXPECT_EQ(computed, saved);
}

// The caller's thread cannot do two things at once; as in graph_test.cpp.
TEST_F(RunnerTest, WithOneThreadEveryStageRunsInTheCallersThread) {
  ToyRun toy(data_.path(), store_);
  const auto caller = std::this_thread::get_id();
  Meeting somebody_else(2, std::chrono::milliseconds(200));
  for (Row& row : toy.catalog.rows)
    do_before(row, [&](const JobInputs&) {
      EXPECT_EQ(std::this_thread::get_id(), caller);
      somebody_else.join();
    });
  toy.run(1);
  EXPECT_FALSE(somebody_else.met());
  EXPECT_EQ(toy.count(Verdict::done), jobs_.of_shapes());
}

TEST_F(RunnerTest, OneRemovedArtefactIsComputedAgainAndNothingElse) {
  run();
  for (const auto& [stage, item] : std::vector<std::pair<std::string, std::string>>{{"mesh", "1"},
                                                                                    {"scan", "1_3"},
                                                                                    {"fpfh", "1_3"},
                                                                                    {"map.PS", "2"},
                                                                                    {"scores.PS", "2_11"},
                                                                                    {"matched.RS", "1"}}) {
    store_.remove(stage, item);
    // It comes out as it was, so whatever depends on it is still valid: early cut-off.
    EXPECT_THAT(run(), ElementsAre(stage + "@" + item));
  }
}

TEST_F(RunnerTest, ADamagedArtefactIsComputedAgainWhenItIsRead) {
  run();
  const std::string before = results_;
  store_.damage("fpfh", "1_3");
  store_.remove("map.PS", "1_3");
  EXPECT_THAT(run(), ElementsAre("fpfh@1_3", "map.PS@1_3"));
  store_.damage("scores.PS", "2");
  EXPECT_THAT(run(), ElementsAre("scores.PS@2"));
  EXPECT_EQ(results_, before);
}

// A configuration of every model, in which one of them has another option.
std::string every_model(std::string_view changed = "", std::string_view option = "") {
  std::string yaml = "scan: {step_degrees: 1}\nmodels:\n";
  for (const ModelRow& row : model_rows())
    yaml += fmt::format("  {}: {{{}}}\n", row.name, row.name == changed ? option : "");
  return yaml;
}

TEST_F(RunnerTest, AnOptionOfAModelConcernsThatModelAlone) {
  const std::map<std::string_view, std::string_view> options = {
      {"LS", "foci_sigma: 0.08"}, {"CS", "clusters: 40"}, {"PS", "absolute: true"},
      {"MS", "window: 5"},        {"HS", "draws: 3"},
  };
  run(every_model());
  EXPECT_THAT(failures_, IsEmpty());
  for (const ModelRow& row : model_rows()) {
    if (row.bind(Section::from_text("{}", ""), Protocol::published).options.empty())
      continue;  // nothing to change
    SCOPED_TRACE(row.name);
    ASSERT_TRUE(options.contains(row.name)) << "a new model: name one of its options above";
    const auto computed = run(every_model(row.name, options.at(row.name)));
    std::map<std::string, std::size_t> jobs;
    for (const std::string& job : computed) ++jobs[job.substr(0, job.find('@'))];
    const std::string name(row.name);
    // People are compared on the two meshes, and their options are those of the curve alone.
    const std::map<std::string, std::size_t> of_people = {{"curve." + name, 2}};
    const std::map<std::string, std::size_t> of_maps = {
        {"map." + name, jobs_.shapes()},
        {"matched." + name, jobs_.shapes()},
        {"scores." + name, jobs_.shapes()},
        {"mean_histogram." + name, jobs_.of("mean_histogram.PS")}};
    EXPECT_EQ(jobs, name == "HS" ? of_people : of_maps);
    EXPECT_THAT(run(every_model()), IsEmpty());  // and back: both are in the cache
  }
}

TEST_F(RunnerTest, AMetricOptionConcernsTheScoresAlone) {
  run();
  const auto computed = run(std::string(kToyConfig) + "metrics: {splits: 7}\n");
  EXPECT_THAT(computed, SizeIs(jobs_.of_kind("scores")));
  for (const std::string& job : computed) EXPECT_THAT(job, HasSubstr("scores."));
}

TEST_F(RunnerTest, OtherMetricsConcernTheScoresAlone) {
  run();
  const std::string paper_results = results_;
  const auto computed = run(std::string(kToyConfig) + "metrics: [kl, auc, auc_judd_area]\n");
  EXPECT_THAT(computed, SizeIs(jobs_.of_kind("scores")));
  for (const std::string& job : computed) EXPECT_THAT(job, HasSubstr("scores."));
  EXPECT_THAT(results_, HasSubstr("model,auc,kl,auc_judd_area,n_points"));
  EXPECT_THAT(run(std::string(kToyConfig) + "metrics: {names: [auc_judd_area, kl, auc]}\n"), IsEmpty())
      << "the order in a file makes no other key";
  EXPECT_THAT(run(std::string(kToyConfig) + "metrics: [lcc, cc, nss, auc_exact, auc]\n"), IsEmpty())
      << "the paper's by name are the default";
  EXPECT_EQ(results_, paper_results);
}

TEST_F(RunnerTest, EveryMetricIsFiniteOnMeshesAndScansAndForPeople) {
  ToyRun toy(data_.path(), store_, "scan: {step_degrees: 1}\nmodels: {PS: , HS: }\nmetrics: all\n");
  toy.run();
  EXPECT_THAT(toy.runner.failures(), IsEmpty());
  for (const ResultRow& row : toy.results()) {
    ASSERT_THAT(row.scores.values, SizeIs(metric_table().size()));
    for (std::size_t m = 0; m < metric_table().size() && row.scores.n_picks > 0; ++m)
      EXPECT_TRUE(std::isfinite(row.value(m)))
          << metric_table()[m].name << " of " << row.item << " " << row.view;
  }
}

TEST_F(RunnerTest, OnlyScoresByAreaReadTheSurface) {
  const auto inputs_of = [&](const std::string& metrics) {
    const ToyRun toy(data_.path(), store_, std::string(kToyConfig) + metrics);
    std::vector<std::string> names;
    for (const std::size_t input : toy.catalog.rows[toy.row("scores.PS", Shapes::scans)].inputs)
      names.push_back(toy.catalog.rows[input].name);
    return names;
  };
  EXPECT_THAT(inputs_of("metrics: [nss, kl]\n"), ElementsAre("matched.PS", "scan_ground_truth"));
  EXPECT_THAT(inputs_of("metrics: [nss, kl_area]\n"),
              ElementsAre("matched.PS", "scan_ground_truth", "scan", "surface"));
}

TEST_F(RunnerTest, TheTableByClassHasEachMetricButForThePapers) {
  run();
  const auto columns = [&](const std::string& metrics) {
    ToyRun toy(data_.path(), store_, std::string(kToyConfig) + metrics);
    toy.run();
    std::vector<ResultRow> rows = toy.results();
    for (ResultRow& row : rows) row.category = "human";
    return per_class_table(rows, chosen_metrics(toy.config.metrics)).columns;
  };
  EXPECT_THAT(columns(""), ElementsAre("dataset", "class", "model", "n", "auc_mean", "auc_ci95"));
  EXPECT_THAT(columns("metrics: [kl, nss]\n"),
              ElementsAre("dataset", "class", "model", "n", "nss_mean", "nss_ci95", "kl_mean", "kl_ci95"));
}

TEST_F(RunnerTest, AnEditedMeshConcernsItsFamilyAndTheReference) {
  run();
  Mesh edited = shapes::bumpy_sphere(2);
  edited.vertices[0] *= 1.01;
  write_file(data_ / "Meshes/1.off", off_text(edited));
  const auto computed = run();
  for (const std::string& job : computed)
    EXPECT_THAT(job, testing::AnyOf(HasSubstr("@1"), HasSubstr("reference@"), HasSubstr("mean_histogram."),
                                    HasSubstr("matched."), HasSubstr("scores.")));
  EXPECT_THAT(computed, Contains("map.PS@1_0"));
  EXPECT_THAT(computed, Not(Contains("map.PS@2_0")));
}

TEST_F(RunnerTest, ANewlyWrittenButEqualFileConcernsNothing) {
  run();
  write_file(data_ / "Meshes/1.off", off_text(shapes::bumpy_sphere(2)));
  EXPECT_THAT(run(), IsEmpty());
  // Another spelling of the same mesh: read again, found equal, and no further.
  write_file(data_ / "Meshes/1.off", "# a comment\n" + off_text(shapes::bumpy_sphere(2)));
  EXPECT_THAT(run(), ElementsAre("mesh@1"));
}

TEST_F(RunnerTest, AnotherSeedConcernsWhatIsRandom) {
  run();
  const auto computed = run(std::string(kToyConfig) + "seed: 7\n");
  EXPECT_THAT(computed, SizeIs(jobs_.of_model("RS") + jobs_.of("scores.PS")));
}

TEST_F(RunnerTest, AFailingItemStopsNoOther) {
  write_file(data_ / "Meshes/3.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n");
  ToyRun toy(data_.path(), store_);
  toy.run();
  ASSERT_THAT(toy.runner.failures(), SizeIs(1));
  EXPECT_EQ(toy.context.row(toy.runner.failures()[0].job).name, "mesh");
  EXPECT_THAT(toy.runner.failures()[0].cause, HasSubstr("3.off"));
  EXPECT_EQ(toy.count(Verdict::done), jobs_.of_shapes());
  EXPECT_EQ(toy.count(Verdict::failed), 1U);
  EXPECT_EQ(toy.count(Verdict::blocked) + toy.count(Verdict::not_applicable),
            JobCounts(kToyConfig, 1).of_shapes() - 1);
  EXPECT_EQ(toy.results().size(), jobs_.of_kind("scores"));
}

TEST_F(RunnerTest, ItemsWithoutGroundTruthGetMapsAndNoScores) {
  std::filesystem::create_directories(data_ / "Meshes");
  write_file(data_ / "Meshes/3.off", off_text(shapes::bumpy_sphere(2, 0.1)));
  const auto computed = run();
  const std::size_t unscored = JobCounts(kToyConfig, 1).where([](const Row& row) {
    return !row.gathers && row.kind != "ground_truth" && row.kind != "scores";
  });
  EXPECT_THAT(computed, SizeIs(jobs_.all() + unscored));
  EXPECT_THAT(failures_, IsEmpty());
  EXPECT_THAT(computed, Contains("matched.PS@3_5"));
  EXPECT_THAT(results_, Not(HasSubstr("\nmeshes,3,")));
}

TEST_F(RunnerTest, WithoutAnyGroundTruthMapsAreAllThereIs) {
  TemporaryFolder plain;
  write_file(plain / "a.off", off_text(shapes::sphere(2)));
  ToyRun toy(plain.path(), store_);
  toy.run();
  EXPECT_THAT(toy.runner.failures(), IsEmpty());
  const auto computed = store_.take_saved();
  EXPECT_THAT(computed, Contains("map.PS@a_5"));
  EXPECT_THAT(computed, Not(Contains("matched.PS@a_5")));
}

TEST_F(RunnerTest, AStoppedRunResumesToTheSameResults) {
  run();
  const std::string uninterrupted = results_;
  store_.clear();
  std::size_t stored = 0;
  for (const char* stage : {"mesh", "surface", "fpfh", "matched.PS"}) {
    ToyRun toy(data_.path(), store_);
    const Shapes shapes = toy.catalog.has(Shapes::scans, stage) ? Shapes::scans : Shapes::meshes;
    do_before(toy.catalog.rows[toy.row(stage, shapes)], [&](const JobInputs&) { toy.stop = true; });
    toy.run();
    const std::size_t here = store_.take_saved().size();
    EXPECT_GT(here, 0U) << "what was at work when the run was stopped, at " << stage;
    stored += here;
  }
  EXPECT_THAT(run(), SizeIs(jobs_.all() - stored));
  EXPECT_EQ(results_, uninterrupted);
}

TEST_F(RunnerTest, AGivenReferenceReplacesTheMean) {
  ToyRun toy(data_.path(), store_);
  Histogram flat;
  flat.fill(1);
  toy.catalog = make_catalog(toy.config, flat);
  toy.plan = make_plan(toy.context, store_);
  toy.run();
  const auto computed = store_.take_saved();
  EXPECT_THAT(computed, SizeIs(jobs_.all() - jobs_.of("reference")));
  EXPECT_THAT(computed, Not(Contains("reference@meshes")));
}

constexpr const char* kWithPeople = "scan: {step_degrees: 1}\nmodels: {PS: , HS: }\n";

TEST_F(RunnerTest, PeopleAreScoredOnMeshesAlone) {
  const auto computed = run(kWithPeople);
  EXPECT_THAT(failures_, IsEmpty());
  std::vector<std::string> of_people;
  for (const std::string& job : computed)
    if (job.find(".HS@") != std::string::npos) of_people.push_back(job);
  EXPECT_THAT(of_people, ElementsAre("curve.HS@1", "curve.HS@2", "scores.HS@1", "scores.HS@2"));
  EXPECT_THAT(results_, HasSubstr("\nmeshes,1,human,,HS,"));
  EXPECT_THAT(results_, HasSubstr("\nscans,1,human,0,PS,"));
  EXPECT_THAT(results_, Not(HasSubstr("\nscans,1,human,0,HS,")));
  EXPECT_THAT(run(kWithPeople), IsEmpty());
}

TEST_F(RunnerTest, HumanCurvesAreAveragedOverMeshes) {
  ToyRun toy(data_.path(), store_, kWithPeople);
  toy.run();
  const auto curves = collect_human_curves(toy.state());
  ASSERT_THAT(curves, SizeIs(2));
  const Table table = human_curve_table(curves);
  EXPECT_THAT(table.columns, ElementsAre("n", "metric", "n_meshes", "mean", "sd", "ci95_low", "ci95_high"));
  const std::size_t n_metrics = chosen_metrics({}).size();
  ASSERT_THAT(table.rows, SizeIs(2 * n_metrics));  // four participants: 1 and 2 against as many
  const auto& cc_of_two = table.rows[n_metrics + 3];
  EXPECT_EQ(cc_of_two[0], Cell(std::int64_t{2}));
  EXPECT_EQ(cc_of_two[1], Cell("cc"));
  EXPECT_EQ(cc_of_two[2], Cell(std::int64_t{2}));
  EXPECT_DOUBLE_EQ(std::get<double>(cc_of_two[3]),
                   (value_of(curves[0][1], "cc") + value_of(curves[1][1], "cc")) / 2);
}

TEST_F(RunnerTest, AHumanCurveOfAnEarlierRunIsNotLeftBehind) {
  TemporaryFolder out;
  const auto run_and_write = [&](const std::string& yaml) {
    ToyRun toy(data_.path(), store_, yaml);
    toy.run();
    write_tables(out.path(), toy.state(), toy.results(), {});
    return std::filesystem::exists(out / "human_curve.csv");
  };
  EXPECT_TRUE(run_and_write(kWithPeople));
  EXPECT_THAT(read_file(out / "human_curve.csv"), HasSubstr("n,metric,n_meshes,mean,"));
  EXPECT_FALSE(run_and_write(kToyConfig));
}

TEST_F(RunnerTest, PeopleDoNotApplyToPooledPicks) {
  for (const char* participant : {"1", "2", "3"})
    std::filesystem::remove(data_ / "RawData" / ("2_" + std::string(participant) + ".pid"));
  ToyRun toy(data_.path(), store_, kWithPeople);
  const auto job = [&](std::size_t family) { return toy.mesh_job("scores.HS", family); };
  EXPECT_TRUE(job(0).open());
  EXPECT_EQ(job(1).verdict, Verdict::not_applicable);
  EXPECT_EQ(job(1).reason, Reason::inapplicable);
  toy.run();
  EXPECT_THAT(toy.runner.failures(), IsEmpty());
  const std::string results = to_csv(results_table(toy.results()));
  EXPECT_THAT(results, HasSubstr("\nmeshes,1,human,,HS,"));
  EXPECT_THAT(results, HasSubstr("\nmeshes,2,human,,PS,"));
  EXPECT_THAT(results, Not(HasSubstr("\nmeshes,2,human,,HS,")));
}

TEST_F(RunnerTest, OfSimulatedPeopleThereMustBeTwoToo) {
  const auto with = [](int participants) {
    return fmt::format(
        "dataset: {{participants: simulated, scans: false}}\nsimulation: {{participants: {}}}\n"
        "models: {{HS: {{draws: 2}}}}\n",
        participants);
  };
  EXPECT_THAT(run(with(2)), Contains("scores.HS@1"));
  EXPECT_THAT(run(with(1)), Not(Contains("scores.HS@1")));  // though there are .pid files of four
  EXPECT_THAT(failures_, IsEmpty());
}

// A store that is full must end the run at once, not item by item.
class FullStore final : public Store {
 public:
  std::optional<Digest> find(std::string_view, const Digest&) const override { return {}; }
  bool has_item(std::string_view, std::string_view) const override { return false; }
  std::optional<Digest> refresh_and_find(std::string_view, const Digest&) override { return {}; }
  std::optional<Arrays> load(std::string_view, const Digest&) override { return {}; }
  Digest save(const Recipe&, std::string_view, const Arrays&, const ArtefactNote&) override {
    throw StorageError("no space left");
  }
};

TEST_F(RunnerTest, AFullCacheEndsTheRun) {
  FullStore full;
  ToyRun toy(data_.path(), full);
  EXPECT_THROW(toy.run(), StorageError);
}

}  // namespace
}  // namespace salbench
