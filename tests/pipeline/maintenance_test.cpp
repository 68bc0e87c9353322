// SPDX-License-Identifier: GPL-3.0-or-later
// Cache maintenance, over real runs on a toy data set.

#include "cache/layout.h"
#include "io/file.h"
#include "pipeline/engine/maintain.h"
#include "tests/pipeline/runner_fixture.h"
#include "tests/support/cache_files.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

const std::atomic<bool> kGoOn = false;
NoProgress progress;
constexpr const char* kPs = "dataset: {scans: false}\nmodels: {PS: }\n";
constexpr const char* kRs = "dataset: {scans: false}\nmodels: {RS: }\n";

class MaintenanceTest : public testing::Test {
 protected:
  void SetUp() override { write_two_toy_items(data_.path()); }

  FolderStore store(Access access = Access::read_write) const { return {cache_.path(), access}; }
  std::size_t run(const std::string& yaml) const {  // returns how many artefacts it computed
    FolderStore cache = store();
    ToyRun toy(data_.path(), cache, yaml);
    toy.run();
    return toy.resolver->computed();
  }
  // Runs gc; returns the number of jobs without a key.
  std::size_t collect(const std::vector<std::string>& yamls) const {
    KeepSet needed;
    std::size_t unknown = 0;
    for (const std::string& yaml : yamls) {
      FolderStore cache = store(Access::read_only);
      const ToyRun toy(data_.path(), cache, yaml);
      unknown += add_needed(toy.project, toy.plan(), needed);
    }
    collect_garbage(cache_.path(), needed, false, progress);
    return unknown;
  }
  std::vector<std::string> artefacts() const { return artefact_names(cache_.path()); }

  TemporaryFolder data_, cache_;
};

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

// Without the descriptors, keys of the maps are unknown; the maps may still be valid, and here are.
TEST_F(MaintenanceTest, ResultsBehindAJobThatWaitsAreKept) {
  const std::size_t all = run(kPs);
  const auto before = artefacts();
  lose(cache_.path(), "fpfh");
  EXPECT_GT(collect({kPs}), 0U);
  EXPECT_EQ(artefacts().size(), all - 2);
  EXPECT_EQ(run(kPs), 2U) << "the descriptors, and nothing else";
  EXPECT_EQ(artefacts().size(), before.size());
}

TEST_F(MaintenanceTest, ResultsOfAnItemWhoseFileCannotBeReadAreKept) {
  const std::size_t all = run(kPs);
  FolderStore cache = store(Access::read_only);
  ToyRun toy(data_.path(), cache, kPs);
  toy.inputs.shape_files->at(1) = {{.name = "mesh file .off", .place = "/nowhere/2.off"}};
  toy.make_plan_again();
  KeepSet needed;
  EXPECT_GT(add_needed(toy.project, toy.plan(), needed), 0U);
  collect_garbage(cache_.path(), needed, false, progress);
  EXPECT_EQ(artefacts().size(), all);
}

TEST_F(MaintenanceTest, ASampleComputedAgainComesOutTheSame) {
  run(kToyConfig);
  FolderStore cache = store(Access::read_only);
  const ToyRun toy(data_.path(), cache);
  const auto before = artefacts();
  const Recomputation result = recompute_sample(toy.project, toy.plan(), cache, 40, kGoOn);
  EXPECT_EQ(result.jobs, 40U);
  EXPECT_THAT(result.faults, IsEmpty());
  EXPECT_EQ(artefacts(), before) << "nothing is stored";
  const Recomputation all = recompute_sample(toy.project, toy.plan(), cache, 1000000, kGoOn);
  EXPECT_EQ(all.jobs, JobCounts().all());
  EXPECT_THAT(all.faults, IsEmpty());
}

TEST_F(MaintenanceTest, AStageThatNowComputesSomethingElseIsNamed) {
  run(kPs);
  FolderStore cache = store(Access::read_only);
  ToyRun toy(data_.path(), cache, kPs);
  Rule& rule = toy.rule("normals");
  rule.compute = [was = rule.compute](const JobInputs& in) {
    Normals normals = value_as<Normals>(*was(in));
    normals.front() *= -1;
    return held(normals);
  };
  const Recomputation result = recompute_sample(toy.project, toy.plan(), cache, 1000000, kGoOn);
  ASSERT_THAT(result.faults, SizeIs(2));
  for (const Fault& fault : result.faults) {
    EXPECT_THAT(fault.what, HasSubstr("computed again, its content is "));
    EXPECT_THAT(fault.file.string(), HasSubstr("/normals/"));
  }
}

TEST_F(MaintenanceTest, WhatReadsADamagedArtefactIsNamed) {
  run(kPs);
  FolderStore cache = store(Access::read_only);
  const ToyRun toy(data_.path(), cache, kPs);
  damage(cache_.path(), "fpfh", "1");
  const Recomputation result = recompute_sample(toy.project, toy.plan(), cache, 1000000, kGoOn);
  ASSERT_THAT(result.faults, SizeIs(1));
  EXPECT_THAT(result.faults[0].file.string(), HasSubstr("/map.PS/"));
  EXPECT_THAT(result.faults[0].what, HasSubstr("damaged"));
}

}  // namespace
}  // namespace salbench
