// SPDX-License-Identifier: GPL-3.0-or-later
// Every component of a key, changed alone, is the one that is named.
#include "pipeline/commands/explain.h"

#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cache/folder_store.h"
#include "stages/core/errors.h"
#include "tests/support/cache_files.h"
#include "tests/support/job_counts.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::EndsWith;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using testing::SizeIs;
using testing::StartsWith;

constexpr const char* kOnMeshes = "dataset: {scans: false}\nmodels: {PS: , RS: }\n";
constexpr const char* kOtherPs = "dataset: {scans: false}\nmodels: {PS: {absolute: true}, RS: }\n";

using Counts = std::vector<std::pair<std::string, std::size_t>>;

class ExplainTest : public testing::Test {
 protected:
  void SetUp() override { write_two_toy_items(data_.path()); }

  fs::path cache() const { return cache_ / "cache"; }

  // Reasons of what the run computed, as run.yaml counts them.
  Counts run(const std::string& yaml = kOnMeshes, const std::string& stage = "mesh") const {
    FolderStore store(cache(), Access::read_write);
    ToyRun toy(data_.path(), store, yaml);
    toy.run();
    toy.results();
    Causes causes(toy.project, toy.plan(), cache(), kOpenedForCounting);
    return counts(toy, stage, why_computed(causes));
  }

  // Reasons as `salbench plan` counts them.
  Counts planned(const std::string& yaml, const std::string& stage,
                 std::size_t limit = kOpenedForCounting) const {
    FolderStore store(cache(), Access::read_only);
    const ToyRun toy(data_.path(), store, yaml);
    Causes causes(toy.project, toy.plan(), cache(), limit);
    return counts(toy, stage, why_open(causes));
  }

  static Counts counts(const ToyRun& toy, const std::string& stage, const Why& why) {
    for (const StageCount& count : count_by_stage(toy.project, toy.plan(), why))
      if (count.stage == stage) return count.reasons;
    ADD_FAILURE() << "no stage " << stage;
    return {};
  }

  using Change = std::function<void(Rules&)>;
  std::vector<Explanation> explained(const std::string& yaml, const std::string& item,
                                     const std::string& stage = "", const Change& change = {}) const {
    FolderStore store(cache(), Access::read_only);
    ToyRun toy(data_.path(), store, yaml);
    if (change) change(toy.project.rules);
    return explain(toy.project, store, cache(), item, stage);
  }

  // "state: why" of one stage of the mesh "1".
  std::string asked(const std::string& stage, const std::string& yaml = kOnMeshes,
                    const std::string& item = "1", const Change& change = {}) const {
    const auto found = explained(yaml, item, stage, change);
    EXPECT_THAT(found, SizeIs(1));
    return found.front().state + ": " + found.front().why;
  }

  fs::path artefact(const std::string& stage, const std::string& item) const {
    return file_with(cache(), stage, item);
  }
  void edit_mesh() const {
    Mesh edited = shapes::bumpy_sphere(2);
    edited.vertices[0] *= 1.01;
    write_file(data_ / "Meshes/1.off", off_text(edited));
  }

  TemporaryFolder data_, cache_;
};

TEST_F(ExplainTest, AHitNeedsNoReason) {
  run();
  const auto all = explained(kOnMeshes, "1");
  EXPECT_THAT(all, SizeIs(JobCounts(kOnMeshes, 1).of_shapes()));
  EXPECT_THAT(all, Each(AllOf(Field(&Explanation::state, "cached"), Field(&Explanation::why, ""))));
  EXPECT_EQ(all[0].file, artefact("mesh", "1"));
}

TEST_F(ExplainTest, OfWhatWasNeverComputedThereIsNoArtefact) {
  EXPECT_EQ(asked("mesh"), "to compute: no artefact of this stage and item");
  EXPECT_EQ(asked("normals"), "waiting: waits for mesh: no artefact of this stage and item");
  EXPECT_FALSE(fs::exists(cache()));
}

TEST_F(ExplainTest, AnOptionIsNamedWithItsPathAndBothValues) {
  run();
  EXPECT_EQ(asked("map.PS", kOtherPs), "to compute: models.PS.absolute false -> true");
  EXPECT_EQ(asked("matched.PS", kOtherPs), "waiting: waits for map.PS: models.PS.absolute false -> true");
  EXPECT_EQ(asked("scores.PS", kOtherPs),
            "waiting: waits for matched.PS, waits for map.PS: models.PS.absolute false -> true");
  EXPECT_EQ(asked("map.RS", kOtherPs), "cached: ");
  EXPECT_EQ(asked("scores.RS", std::string(kOnMeshes) + "metrics: {splits: 7, thresholds: 50}\n"),
            "to compute: metrics.splits 100 -> 7, metrics.thresholds 20 -> 50");
}

TEST_F(ExplainTest, OptionsOfTwoSectionsKeepTheirPaths) {
  const std::string people = "dataset: {scans: false}\nmodels: {HS: {draws: 2}}\n";
  run(people);
  EXPECT_EQ(asked("curve.HS", "dataset: {scans: false}\nmetrics: {splits: 7}\nmodels: {HS: {draws: 3}}\n"),
            "to compute: models.HS.draws 2 -> 3, metrics.splits 100 -> 7");
}

TEST_F(ExplainTest, ARaisedStageVersionIsNamed) {
  run();
  const Change raise = [](Rules& rules) { rules[find_rule(rules, kMeshes, "fpfh")].version = 2; };
  EXPECT_EQ(asked("fpfh", kOnMeshes, "1", raise), "to compute: stage version 1 -> 2");
  EXPECT_EQ(asked("map.PS", kOnMeshes, "1", raise), "waiting: waits for fpfh: stage version 1 -> 2");
  EXPECT_EQ(asked("map.RS", kOnMeshes, "1", raise), "cached: ");
}

TEST_F(ExplainTest, AnotherSeedIsNamed) {
  run();
  const std::string reseeded = std::string(kOnMeshes) + "seed: 7\n";
  EXPECT_EQ(asked("map.RS", reseeded), "to compute: seed 2016/1 -> 7/1");
  EXPECT_THAT(planned(reseeded, "map.RS"), ElementsAre(Pair("seed 2016 -> 7", 2)));
}

// No word of change: the one in the cache may be that of another data set, with a mesh of the same name.
TEST_F(ExplainTest, AnEditedMeshIsNamedByItsFile) {
  run();
  edit_mesh();
  EXPECT_EQ(asked("mesh"), "to compute: mesh file 1.off: other contents");
  EXPECT_EQ(asked("map.PS"), "waiting: waits for mesh: mesh file 1.off: other contents");
  EXPECT_EQ(asked("mesh", kOnMeshes, "2"), "cached: ");
  EXPECT_THAT(planned(kOnMeshes, "mesh"), ElementsAre(Pair("mesh file .off: other contents", 1)));
}

TEST_F(ExplainTest, AFileThatIsReadNoMoreKeepsTheNameInItsKey) {
  run();
  const auto in_another_format = [](Rules& rules) {
    File& file = rules[0].files->at(0)[0];
    file.name = "mesh file .ply";
    file.title = "mesh file 1.ply";
  };
  EXPECT_EQ(asked("mesh", kOnMeshes, "1", in_another_format),
            "to compute: mesh file 1.ply added, mesh file .off removed");
}

TEST_F(ExplainTest, AChangedInputIsTracedToWhatChangedIt) {
  run();
  edit_mesh();
  run("dataset: {scans: false}\nmodels: {PS: }\n");  // the new mesh is now in the cache, a map of it is not
  EXPECT_EQ(asked("map.RS"), "to compute: input mesh changed (mesh file 1.off: other contents)");
  EXPECT_THAT(planned(kOnMeshes, "map.RS"), ElementsAre(Pair("input mesh changed", 1)));
}

TEST_F(ExplainTest, AChangedReferenceIsTracedToTheItemsItIsTheMeanOf) {
  run();
  std::string values;
  for (int i = 0; i < 162; ++i) values += fmt::format("{}\n", i);
  write_file(data_ / "Distributions/1.val", values);
  run("dataset: {scans: false}\nmodels: {PS: }\n");
  EXPECT_EQ(asked("matched.RS", kOnMeshes, "2"), "to compute: input reference changed (that of 1 changed)");
}

TEST_F(ExplainTest, AnEditedGroundTruthIsNamedByItsFile) {
  run();
  write_file(data_ / "RawData/1_3.pid", "0\n5\n");
  EXPECT_EQ(asked("ground_truth"), "to compute: picks 3: other contents");
  EXPECT_EQ(asked("matched.PS", kOnMeshes, "2"),
            "waiting: waits for reference, waits for ground_truth of 1: picks 3: other contents");
  EXPECT_EQ(asked("map.PS"), "cached: ");
  fs::remove(data_ / "RawData/1_3.pid");
  EXPECT_EQ(asked("ground_truth"), "to compute: picks 3 removed");
  fs::remove(data_ / "Distributions/1.val");
  EXPECT_EQ(asked("ground_truth"), "to compute: saliency file removed, picks 3 removed");
}

TEST_F(ExplainTest, OfADeletedArtefactThereIsNone) {
  run();
  lose(cache(), "normals", "1");
  EXPECT_EQ(asked("normals"), "to compute: no artefact of this stage and item");
  EXPECT_EQ(asked("map.PS"),
            "waiting: waits for fpfh, waits for normals: no artefact of this stage and item");
  EXPECT_EQ(asked("normals", kOnMeshes, "2"), "cached: ");
  EXPECT_THAT(run(kOnMeshes, "normals"), ElementsAre(Pair("not in the cache", 1)));
}

TEST_F(ExplainTest, ADamagedArtefactIsNamed) {
  run();
  const fs::path file = artefact("fpfh", "1");
  damage(cache(), "fpfh", "1");
  EXPECT_EQ(asked("fpfh"), "damaged: " + file.string() + ": checksum mismatch in its record");
  EXPECT_EQ(asked("map.PS"), "cached: ");  // what was made of it is sound
  damage(cache(), "fpfh", "1");            // the byte is turned back
  lose(cache(), "map.PS", "1");
  damage(cache(), "fpfh", "1");
  EXPECT_THAT(run(kOnMeshes, "fpfh"), ElementsAre(Pair("damaged", 1)));
  EXPECT_EQ(asked("fpfh"), "cached: ");
}

TEST_F(ExplainTest, ATruncatedArtefactIsNamed) {
  run();
  const fs::path file = artefact("matched.RS", "1");
  fs::resize_file(file, read_file(file).find("\x89HDF") + 600);  // the head is whole
  EXPECT_THAT(asked("matched.RS"), StartsWith("damaged: " + file.string() + ": truncated: "));
}

// With the head of a file goes what it had.
TEST_F(ExplainTest, AFileWithoutItsHeadIsAsIfItWereNotThere) {
  run();
  fs::resize_file(artefact("mesh", "1"), 10);
  EXPECT_EQ(asked("mesh"), "to compute: no artefact of this stage and item");
}

TEST_F(ExplainTest, TheNearestArtefactIsTheOneHeldAgainst) {
  run();
  run(std::string(kOnMeshes) + "seed: 3\nmetrics: {splits: 7}\n");
  const std::string splits_eight = std::string(kOnMeshes) + "metrics: {splits: 8}\n";
  EXPECT_EQ(asked("scores.PS", splits_eight), "to compute: metrics.splits 100 -> 8");
  EXPECT_EQ(asked("scores.PS", splits_eight + "seed: 3\n"), "to compute: metrics.splits 7 -> 8");
}

TEST_F(ExplainTest, ScansWaitForTheirMesh) {
  run(kToyConfig);
  edit_mesh();
  EXPECT_EQ(asked("scan", kToyConfig, "1_3"),
            "waiting: waits for mesh of 1: mesh file 1.off: other contents");
  EXPECT_EQ(asked("scan", "scan: {step_degrees: 2}\nmodels: {PS: }\n", "2_3"),
            "to compute: scan.step_degrees 1 -> 2");
  EXPECT_THAT(planned("scan: {step_degrees: 2}\nmodels: {PS: }\n", "scan"),
              ElementsAre(Pair("scan.step_degrees 1 -> 2", kViews), Pair("waits for mesh", kViews)));
}

TEST_F(ExplainTest, ARunSaysWhyItComputed) {
  EXPECT_THAT(run(kOnMeshes, "map.PS"), ElementsAre(Pair("not in the cache", 2)));
  EXPECT_THAT(run(kOnMeshes, "map.PS"), IsEmpty());
  EXPECT_THAT(run(kOtherPs, "matched.PS"), ElementsAre(Pair("input map.PS changed", 2)));
  EXPECT_THAT(run(std::string(kOnMeshes) + "metrics: {splits: 7}\n", "scores.RS"),
              ElementsAre(Pair("metrics.splits 100 -> 7", 2)));
}

TEST_F(ExplainTest, AMeanSaysWhatItIsTakenOver) {
  EXPECT_THAT(run(kOnMeshes, "mean_histogram.PS"), ElementsAre(Pair("not in the cache", 1)));
  EXPECT_THAT(planned(kOnMeshes, "mean_histogram.PS"), IsEmpty());
  EXPECT_THAT(planned(kOtherPs, "mean_histogram.PS"), ElementsAre(Pair("waits for map.PS", 1)));
  EXPECT_THAT(run(kOtherPs, "mean_histogram.PS"), ElementsAre(Pair("2 map.PS changed", 1)));
  write_toy_item(data_.path(), "3", shapes::bumpy_sphere(2, 0.1));
  EXPECT_THAT(run(kOnMeshes, "reference"), ElementsAre(Pair("1 ground_truth added", 1)));
}

TEST_F(ExplainTest, CountingOpensNoMoreArtefactsThanItMay) {
  run();
  EXPECT_THAT(planned(kOtherPs, "map.PS"), ElementsAre(Pair("models.PS.absolute false -> true", 2)));
  EXPECT_THAT(planned(kOtherPs, "map.PS", 1),
              testing::UnorderedElementsAre(Pair("models.PS.absolute false -> true", 1),
                                            Pair("options, inputs, seed or version changed", 1)));
}

TEST_F(ExplainTest, WordsThatNameNothingAreRefused) {
  const auto expect_refusal = [&](const std::string& item, const std::string& stage, const auto& words) {
    EXPECT_THAT([&] { explained(kOnMeshes, item, stage); }, testing::ThrowsMessage<ConfigError>(words));
  };
  expect_refusal("3", "", HasSubstr("no item '3'"));
  expect_refusal("1_0", "", HasSubstr("no item '1_0'"));  // no scans in this configuration
  expect_refusal("1", "map.PSS", EndsWith("did you mean 'map.PS'?"));
}

}  // namespace
}  // namespace salbench
