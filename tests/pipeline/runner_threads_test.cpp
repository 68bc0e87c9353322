// SPDX-License-Identifier: GPL-3.0-or-later
// What runs at the same time, and where.
#include <chrono>
#include <map>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/engine/run.h"
#include "tests/pipeline/runner_fixture.h"
#include "tests/support/meeting.h"

namespace salbench {
namespace {

TEST_F(RunnerTest, ResultsDoNotDependOnThreads) {
  run(kToyConfig, 1);
  const std::string one = results_;
  store_.clear();
  run(kToyConfig, 4);
  EXPECT_EQ(results_, one);
}

TEST_F(RunnerTest, WithTwoThreadsTwoMeshesAreWorkedOnAtTheSameTime) {
  ToyRun toy(data_.path(), store_);
  Meeting both(2);
  do_before(toy.rule("normals"), [&](const JobInputs&) { EXPECT_TRUE(both.join()); });
  toy.run(2);
  EXPECT_TRUE(both.met());
}

TEST_F(RunnerTest, WithTwoThreadsTwoScansOfAMeshAreWorkedOnAtTheSameTime) {
  ToyRun toy(data_.path(), store_, kToyConfig, "1");
  Meeting both(2);
  do_before(toy.rule("scan_normals", kScans), [&](const JobInputs& in) {
    if (in.place == 3 || in.place == 7) {
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
    do_before(toy.rule(model), [&](const JobInputs&) { EXPECT_TRUE(both.join()); });
  toy.run(2);
  EXPECT_TRUE(both.met());
}

TEST_F(RunnerTest, EveryComputedArtefactPassedThroughTheNodeOfItsRow) {
  ToyRun toy(data_.path(), store_);
  toy.run();
  std::map<std::string, std::size_t> computed, saved;
  for (std::size_t rule = 0; rule < toy.project.rules.size(); ++rule) {
    const RuleRecord& node = toy.resolver->records()[rule];
    EXPECT_EQ(node.finished, toy.plan().decisions[rule].size()) << toy.project.rules[rule].stage;
    computed[toy.project.rules[rule].stage] += node.seconds.size();
  }
  for (const std::string& artefact : store_.take_saved()) ++saved[artefact.substr(0, artefact.find('@'))];
  EXPECT_EQ(computed, saved);
}

// The caller's thread cannot do two things at once; as in graph_test.cpp.
TEST_F(RunnerTest, WithOneThreadEveryStageRunsInTheCallersThread) {
  ToyRun toy(data_.path(), store_);
  const auto caller = std::this_thread::get_id();
  Meeting somebody_else(2, std::chrono::milliseconds(200));
  for (Rule& rule : toy.project.rules)
    do_before(rule, [&](const JobInputs&) {
      EXPECT_EQ(std::this_thread::get_id(), caller);
      somebody_else.join();
    });
  toy.run(1);
  EXPECT_FALSE(somebody_else.met());
  EXPECT_EQ(toy.count(Verdict::done), jobs_.of_shapes());
}

}  // namespace
}  // namespace salbench
