// SPDX-License-Identifier: GPL-3.0-or-later
// Counts of computed jobs: the engine promises to compute exactly what is missing.

#include "pipeline/engine/run.h"
#include "tests/pipeline/runner_fixture.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST_F(RunnerTest, AFirstRunComputesWhatThePlanForesaysAndASecondNothing) {
  EXPECT_EQ(ToyRun(data_.path(), store_).open(), jobs_.of_shapes());
  EXPECT_THAT(run(), SizeIs(jobs_.all()));
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_EQ(toy_->count(State::known, true), jobs_.of_shapes());
  const std::string first = results();
  const ToyRun second(data_.path(), store_);
  EXPECT_EQ(second.open(), 0U);
  EXPECT_EQ(second.count(State::known), jobs_.of_shapes());
  EXPECT_THAT(run(), IsEmpty());
  EXPECT_EQ(results(), first);
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
    // The result is unchanged, so everything that depends on it remains valid: early cut-off.
    EXPECT_THAT(run(), ElementsAre(stage + "@" + item));
  }
}

TEST_F(RunnerTest, ADamagedArtefactIsComputedAgainWhenItIsRead) {
  run();
  const std::string before = results();
  store_.damage("fpfh", "1_3");
  store_.remove("map.PS", "1_3");
  EXPECT_THAT(run(), ElementsAre("fpfh@1_3", "map.PS@1_3"));
  store_.damage("score_table.PS", "meshes");
  store_.damage("scores.PS", "2");
  EXPECT_THAT(run(), IsEmpty());
  EXPECT_EQ(results(), before);
  EXPECT_THAT(store_.take_saved(), ElementsAre("score_table.PS@meshes", "scores.PS@2"));
}

TEST_F(RunnerTest, ResultsAreReadFromTheTablesOfScores) {
  run();
  const std::string before = results();
  for (const char* item : {"1", "2", "1_3"}) store_.damage("scores.PS", item);
  EXPECT_THAT(run(), IsEmpty());
  EXPECT_EQ(results(), before);
  EXPECT_THAT(store_.take_saved(), IsEmpty()) << "the scores themselves were read";
}

TEST_F(RunnerTest, ResultsOfAnUnfinishedRunAreThoseOfTheScoresThatThereAre) {
  run();
  const auto line_of = [](const ResultRow& row) { return row.model + " " + row.item + " " + row.view; };
  std::vector<std::string> expected;
  for (const ResultRow& row : toy_->results()) expected.push_back(line_of(row));
  std::erase(expected, "PS 2 ");
  store_.remove("scores.PS", "2");
  store_.remove("score_table.PS", "meshes");
  ToyRun planned(data_.path(), store_);
  std::vector<std::string> found;
  for (const ResultRow& row : planned.results()) {
    found.push_back(line_of(row));
    EXPECT_TRUE(planned.plan()[row.job].known());
  }
  EXPECT_EQ(found, expected);
  EXPECT_THAT(store_.take_saved(), IsEmpty());
}

// Configuration with every model, one of them with a changed option.
std::string every_model(std::string_view changed = "", std::string_view option = "") {
  std::string yaml = "scan: {step_degrees: 1}\nmodels:\n";
  for (const ModelRow& row : model_rows())
    yaml += fmt::format("  {}: {{{}}}\n", row.name, row.name == changed ? option : "");
  return yaml;
}

// Changes an option: half the number, or another of the words at the end of its note.
std::string changed(const OptionRow& option) {
  std::int64_t whole = 0;
  double real = 0;
  std::string value = option.value == "true" ? "false" : "true";
  if (parse_option(option.value, whole)) {
    value = std::to_string(whole / 2);
  } else if (parse_option(option.value, real)) {
    value = std::to_string(real / 2);
  } else if (option.note.ends_with(')')) {
    const std::size_t begin = option.note.rfind('(') + 1;
    const auto words = split_list(option.note.substr(begin, option.note.size() - 1 - begin));
    value = words.at(words.at(0) == option.value ? 1 : 0);
  }
  return fmt::format("{}: {}", option.name, value);
}

TEST_F(RunnerTest, AnOptionOfAModelConcernsThatModelAlone) {
  // For models whose first option, halved, does not affect some of the toy data.
  const std::map<std::string_view, std::string_view> other_options = {
      {"LS", "foci_sigma: 0.08"}, {"CS", "clusters: 40"}, {"MS", "window: 5"},
      {"LVJ", "epsilon: 0.01"},   {"LCE", "radius: 0.5"}, {"NV", "radius: 0.1"},
  };
  run(every_model());
  EXPECT_THAT(failures(), IsEmpty());
  for (const ModelRow& row : model_rows()) {
    const std::vector<OptionRow> options =
        row.bind(Section::from_text("{}", ""), Protocol::published).option_rows;
    if (options.empty()) continue;  // nothing to change
    const auto other = other_options.find(row.name);
    const std::string option =
        other == other_options.end() ? changed(options[0]) : std::string(other->second);
    SCOPED_TRACE(fmt::format("{}: {}", row.name, option));
    const auto computed = run(every_model(row.name, option));
    std::map<std::string, std::size_t> jobs;
    for (const std::string& job : computed) ++jobs[job.substr(0, job.find('@'))];
    const std::string name(row.name);
    // People are compared on the two meshes; their options concern only the curve.
    const std::map<std::string, std::size_t> of_people = {{"curve." + name, 2}};
    // An option for scans leaves the maps of the two meshes unchanged.
    const bool of_scans = row.name == "SD";
    const std::size_t changed = jobs_.shapes() - (of_scans ? 2 : 0), means = of_scans ? 1 : 2;
    const std::map<std::string, std::size_t> of_maps = {{"map." + name, jobs_.shapes()},
                                                        {"matched." + name, changed},
                                                        {"scores." + name, changed},
                                                        {"score_table." + name, means},
                                                        {"mean_histogram." + name, means}};
    EXPECT_EQ(jobs, name == "HS" ? of_people : of_maps);
    EXPECT_THAT(run(every_model()), IsEmpty());  // back again: both are in the cache
  }
}

TEST_F(RunnerTest, AnEditedMeshConcernsItsFamilyAndTheReference) {
  run();
  Mesh edited = shapes::bumpy_sphere(2);
  edited.vertices[0] *= 1.01;
  write_file(data_ / "Meshes/1.off", off_text(edited));
  const auto computed = run();
  for (const std::string& job : computed)
    EXPECT_THAT(job, AnyOf(HasSubstr("@1"), HasSubstr("reference@"), HasSubstr("mean_histogram."),
                           HasSubstr("matched."), HasSubstr("scores."), HasSubstr("score_table.")));
  EXPECT_THAT(computed, Contains("map.PS@1_0"));
  EXPECT_THAT(computed, Not(Contains("map.PS@2_0")));
}

TEST_F(RunnerTest, AnotherSeedConcernsWhatIsRandom) {
  run();
  const auto computed = run(std::string(kToyConfig) + "seed: 7\n");
  EXPECT_THAT(computed, SizeIs(jobs_.of_model("RS") + jobs_.of("scores.PS") + jobs_.of("score_table.PS")));
}

TEST_F(RunnerTest, ItemsWithoutGroundTruthGetMapsAndNoScores) {
  std::filesystem::create_directories(data_ / "Meshes");
  write_file(data_ / "Meshes/3.off", off_text(shapes::bumpy_sphere(2, 0.1)));
  const auto computed = run();
  const std::size_t unscored = JobCounts(kToyConfig, 1).where([](const Rule& rule) {
    return !rule.gathers && !has_role(rule, Role::ground_truth) && !has_role(rule, Role::scores);
  });
  EXPECT_THAT(computed, SizeIs(jobs_.all() + unscored));
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(computed, Contains("matched.PS@3_5"));
  EXPECT_THAT(results(), Not(HasSubstr("\nmeshes,3,")));
}

TEST_F(RunnerTest, EveryComputedArtefactPassedThroughTheNodeOfItsRow) {
  std::map<std::string, std::size_t> computed, saved;
  for (const std::string& artefact : run()) ++saved[artefact.substr(0, artefact.find('@'))];
  for (std::size_t rule = 0; rule < toy_->project.rules.size(); ++rule) {
    const RuleRecord& node = toy_->resolver->records()[rule];
    EXPECT_EQ(node.settled, toy_->plan().decisions[rule].size()) << toy_->project.rules[rule].stage;
    computed[toy_->project.rules[rule].stage] += node.seconds.size();
  }
  EXPECT_EQ(computed, saved);
}

}  // namespace
}  // namespace salbench
