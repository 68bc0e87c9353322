// SPDX-License-Identifier: GPL-3.0-or-later
// What looks after a cache, over real runs on a toy data set.
#include <algorithm>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cache/layout.h"
#include "io/file.h"
#include "pipeline/commands/accept.h"
#include "pipeline/commands/gc.h"
#include "pipeline/commands/verify.h"
#include "stages/core/errors.h"
#include "tests/support/cache_files.h"
#include "tests/support/job_counts.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const std::atomic<bool> kGoOn = false;
NoProgress progress;
constexpr const char* kPs = "dataset: {scans: false}\nmodels: {PS: }\n";
constexpr const char* kRs = "dataset: {scans: false}\nmodels: {RS: }\n";

class MaintenanceTest : public testing::Test {
 protected:
  void SetUp() override {
    write_toy_item(data_.path(), "1", shapes::bumpy_sphere(2));
    write_toy_item(data_.path(), "2", shapes::bumpy_sphere(2, 0.35));
  }

  FolderStore store(Access access = Access::read_write) const { return {cache_.path(), access}; }
  std::size_t run(const std::string& yaml) const {  // returns how many artefacts it computed
    FolderStore cache = store();
    ToyRun toy(data_.path(), cache, yaml);
    toy.run();
    return toy.runner.computed();
  }
  // What gc does; returns how many jobs had no key.
  std::size_t collect(const std::vector<std::string>& yamls) const {
    KeepSet needed;
    std::size_t unknown = 0;
    for (const std::string& yaml : yamls) {
      FolderStore cache = store(Access::read_only);
      const ToyRun toy(data_.path(), cache, yaml);
      unknown += add_needed(toy.context, toy.plan, needed);
    }
    collect_garbage(cache_.path(), needed, false, progress);
    return unknown;
  }
  std::vector<std::string> artefacts() const {
    std::vector<std::string> names;
    for (const ArtefactFile& file : artefacts_of(cache_.path()))
      names.push_back(file.stage + "/" + file.path.filename().string());
    return names;
  }
  std::size_t files(const std::string& stage) const {
    const auto listed = artefacts_of(cache_.path());
    return static_cast<std::size_t>(std::count_if(
        listed.begin(), listed.end(), [&](const ArtefactFile& file) { return file.stage == stage; }));
  }

  TemporaryFolder data_, cache_;
};

TEST_F(MaintenanceTest, NothingThatTheConfigurationNeedsIsCollected) {
  run(kToyConfig);
  const auto before = artefacts();
  EXPECT_EQ(collect({kToyConfig}), 0U);
  EXPECT_EQ(artefacts(), before);
}

TEST_F(MaintenanceTest, WhatNoNamedConfigurationNeedsIsCollected) {
  run(kPs);
  const auto of_ps = artefacts();
  run(kRs);
  const auto of_both = artefacts();
  ASSERT_GT(of_both.size(), of_ps.size());
  collect({kPs, kRs});
  EXPECT_EQ(artefacts(), of_both);
  collect({kPs});
  EXPECT_EQ(artefacts(), of_ps);
  EXPECT_EQ(run(kPs), 0U);
}

// With the descriptors gone the keys of the maps are not known; they may come out as before, and do.
TEST_F(MaintenanceTest, ResultsBehindAJobThatWaitsAreKept) {
  const std::size_t all = run(kPs);
  const auto before = artefacts();
  fs::remove_all(cache_ / "fpfh");
  EXPECT_GT(collect({kPs}), 0U);
  EXPECT_EQ(artefacts().size(), all - 2);
  EXPECT_EQ(run(kPs), 2U) << "the descriptors, and nothing else";
  EXPECT_EQ(artefacts().size(), before.size());
}

TEST_F(MaintenanceTest, ResultsOfAnItemWhoseFileCannotBeReadAreKept) {
  const std::size_t all = run(kPs);
  FolderStore cache = store(Access::read_only);
  ToyRun toy(data_.path(), cache, kPs);
  toy.workload.families[1].shape_file.front() = source_file("mesh file .off", "/nowhere/2.off");
  toy.plan = make_plan(toy.context, cache);
  KeepSet needed;
  EXPECT_GT(add_needed(toy.context, toy.plan, needed), 0U);
  collect_garbage(cache_.path(), needed, false, progress);
  EXPECT_EQ(artefacts().size(), all);
}

TEST_F(MaintenanceTest, ASampleComputedAgainComesOutTheSame) {
  run(kToyConfig);
  FolderStore cache = store(Access::read_only);
  const ToyRun toy(data_.path(), cache);
  const auto before = artefacts();
  const Recomputation result = recompute_sample(toy.context, toy.plan, cache, 40, kGoOn);
  EXPECT_EQ(result.jobs, 40U);
  EXPECT_THAT(result.faults, IsEmpty());
  EXPECT_EQ(artefacts(), before) << "nothing is stored";
  const Recomputation all = recompute_sample(toy.context, toy.plan, cache, 1000000, kGoOn);
  EXPECT_EQ(all.jobs, JobCounts().all());
  EXPECT_THAT(all.faults, IsEmpty());
}

TEST_F(MaintenanceTest, AStageThatNowComputesSomethingElseIsNamed) {
  run(kPs);
  FolderStore cache = store(Access::read_only);
  ToyRun toy(data_.path(), cache, kPs);
  Row& normals = toy.catalog.rows[toy.row("normals")];
  normals.run = [was = normals.run](const JobInputs& in) {
    Value value = was(in);
    std::get<Normals>(value).front() *= -1;
    return value;
  };
  const Recomputation result = recompute_sample(toy.context, toy.plan, cache, 1000000, kGoOn);
  ASSERT_THAT(result.faults, SizeIs(2));
  for (const Fault& fault : result.faults) {
    EXPECT_THAT(fault.what, HasSubstr("computed again, its content is "));
    EXPECT_TRUE(fs::exists(fault.file));
    EXPECT_THAT(fault.file.string(), HasSubstr("/normals/"));
  }
}

TEST_F(MaintenanceTest, WhatReadsADamagedArtefactIsNamed) {
  run(kPs);
  FolderStore cache = store(Access::read_only);
  const ToyRun toy(data_.path(), cache, kPs);
  for (const ArtefactFile& file : artefacts_of(cache_.path())) {
    if (file.stage != "fpfh" || file.name.item != "1") continue;
    std::fstream(file.path, std::ios::in | std::ios::out).put('x');
  }
  const Recomputation result = recompute_sample(toy.context, toy.plan, cache, 1000000, kGoOn);
  ASSERT_THAT(result.faults, SizeIs(1));
  EXPECT_THAT(result.faults[0].file.string(), HasSubstr("/map.PS/"));
  EXPECT_THAT(result.faults[0].what, HasSubstr("damaged"));
}

class AcceptTest : public MaintenanceTest {
 protected:
  void SetUp() override {
    MaintenanceTest::SetUp();
    all_ = run(kToyConfig);
  }
  static void raise(ToyRun& toy, const std::string& stage) {
    for (Row& row : toy.catalog.rows)
      if (row.name == stage) ++row.version;
    toy.plan = make_plan(toy.context, toy.store);
  }
  // Runs a program in which the stages have the next version; returns how many artefacts it computed.
  std::size_t run_raised(const std::vector<std::string>& stages) const {
    FolderStore cache = store();
    ToyRun toy(data_.path(), cache);
    for (const std::string& stage : stages) raise(toy, stage);
    toy.run();
    return toy.runner.computed();
  }

  std::size_t all_ = 0;
};

TEST_F(AcceptTest, AResultOfAnEarlierVersionIsTakenForThePresentOne) {
  const std::size_t shapes = JobCounts().of("fpfh");
  FolderStore cache = store();
  ToyRun toy(data_.path(), cache);
  raise(toy, "fpfh");
  ASSERT_EQ(toy.count(Verdict::compute), shapes);
  const Accepted first = accept_stage(toy.context, "fpfh", cache, kGoOn);
  EXPECT_EQ(first.accepted, shapes);
  EXPECT_EQ(first.valid + first.missing + first.waiting, 0U);
  const Accepted second = accept_stage(toy.context, "fpfh", cache, kGoOn);
  EXPECT_EQ(second.valid, shapes);
  EXPECT_EQ(second.accepted, 0U);
  EXPECT_EQ(files("fpfh"), 2 * shapes) << "those of the earlier version stay";
  EXPECT_THAT(verify_cache(cache_.path(), kGoOn, progress).faults, IsEmpty());
  EXPECT_EQ(run_raised({"fpfh"}), 0U) << "what depends on them is valid too";
}

TEST_F(AcceptTest, TheArtefactSaysFromWhichVersionItWasAccepted) {
  FolderStore cache = store();
  ToyRun toy(data_.path(), cache);
  raise(toy, "fpfh");
  accept_stage(toy.context, "fpfh", cache, kGoOn);
  std::map<std::int64_t, double> seconds;  // by version, of item 1
  for (const ArtefactFile& file : artefacts_of(cache_.path())) {
    if (file.stage != "fpfh" || file.name.item != "1") continue;
    const Attributes attributes = hdf5_content(*read_bytes(file.path), "artefact").attributes;
    const std::int64_t version = std::get<std::int64_t>(*find_attribute(attributes, "stage_version"));
    const AttributeValue* from = find_attribute(attributes, "accepted_from_version");
    ASSERT_EQ(from != nullptr, version == 2);
    if (from != nullptr) {
      EXPECT_EQ(std::get<std::int64_t>(*from), 1);
    }
    seconds[version] = std::get<double>(*find_attribute(attributes, "seconds"));
  }
  ASSERT_THAT(seconds, SizeIs(2));
  EXPECT_EQ(seconds[1], seconds[2]) << "what it took to compute";
}

TEST_F(AcceptTest, OtherOptionsAreNotAccepted) {
  FolderStore cache = store();
  ToyRun toy(data_.path(), cache, "scan: {step_degrees: 1}\nnormals: {method: pca}\nmodels: {PS: , RS: }\n");
  raise(toy, "normals");
  const Accepted count = accept_stage(toy.context, "normals", cache, kGoOn);
  EXPECT_EQ(count.accepted, 0U);
  EXPECT_EQ(count.missing, 2U);
}

TEST_F(AcceptTest, WhereTwoStagesWereRaisedTheOneThatIsReadComesFirst) {
  FolderStore cache = store();
  ToyRun toy(data_.path(), cache);
  raise(toy, "fpfh");
  raise(toy, "map.PS");
  const Accepted early = accept_stage(toy.context, "map.PS", cache, kGoOn);
  EXPECT_EQ(early.accepted, 0U);
  const std::size_t maps = JobCounts().of("map.PS");
  EXPECT_EQ(early.waiting, maps);
  accept_stage(toy.context, "fpfh", cache, kGoOn);
  EXPECT_EQ(accept_stage(toy.context, "map.PS", cache, kGoOn).accepted, maps);
  EXPECT_EQ(run_raised({"fpfh", "map.PS"}), 0U);
}

TEST_F(AcceptTest, AMeanIsAcceptedLikeAStage) {
  FolderStore cache = store();
  ToyRun toy(data_.path(), cache);
  raise(toy, "reference");
  EXPECT_EQ(accept_stage(toy.context, "reference", cache, kGoOn).accepted, 2U);
  EXPECT_EQ(run_raised({"reference"}), 0U);
}

TEST_F(AcceptTest, ADamagedResultIsNotAccepted) {
  for (const ArtefactFile& file : artefacts_of(cache_.path()))
    if (file.stage == "fpfh" && file.name.item == "1")
      std::fstream(file.path, std::ios::in | std::ios::out).put('x');
  FolderStore cache = store();
  ToyRun toy(data_.path(), cache);
  raise(toy, "fpfh");
  const Accepted count = accept_stage(toy.context, "fpfh", cache, kGoOn);
  EXPECT_EQ(count.accepted, JobCounts().of("fpfh") - 1);
  EXPECT_EQ(count.missing, 1U);
}

TEST_F(AcceptTest, AStageThatThereIsNotIsNamedWithThoseThatThereAre) {
  FolderStore cache = store();
  const ToyRun toy(data_.path(), cache);
  EXPECT_THAT([&] { accept_stage(toy.context, "fphf", cache, kGoOn); },
              testing::ThrowsMessage<ConfigError>(
                  testing::AllOf(HasSubstr("'fphf'"), HasSubstr("fpfh"), HasSubstr("map.PS"))));
}

}  // namespace
}  // namespace salbench
