// SPDX-License-Identifier: GPL-3.0-or-later
// The native program, which needs no Python: it is what builds with a sanitizer run.
#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "tests/e2e/workspace.h"
#include "tests/support/job_counts.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::vector<std::string> engine_command(const Workspace& toy, const std::vector<std::string>& further = {}) {
  std::vector<std::string> words = {SALBENCH_ENGINE, toy.config().string(), toy.data().string(),
                                    toy.cache().string(), toy.out().string()};
  words.insert(words.end(), further.begin(), further.end());
  return words;
}

std::string means_csv(const Workspace& toy) { return read_file(toy.out() / "means.csv"); }

TEST(Engine, ScoresTheDataSetAndComputesNothingTwice) {
  const Workspace toy;
  const Outcome run = run_process(engine_command(toy));
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("\nmeshes   auc        PS "), HasSubstr("2 meshes: ")));
  EXPECT_THAT(lines_with(toy.results(), "meshes,1,"), SizeIs(2));
  EXPECT_EQ(toy.computed(), JobCounts().all());
  const std::string results = toy.results(), of_models = means_csv(toy);
  const auto contents = toy.artefacts();

  EXPECT_EQ(run_process(engine_command(toy)).status, 0);
  EXPECT_EQ(toy.computed(), 0U);
  EXPECT_EQ(toy.results(), results);
  EXPECT_EQ(means_csv(toy), of_models);

  toy.forget_everything();
  ASSERT_EQ(run_process(engine_command(toy, {"1"})).status, 0);
  EXPECT_EQ(toy.results(), results) << "by one thread";
  EXPECT_EQ(toy.artefacts(), contents);
}

TEST(Engine, InterruptedItGoesOnFromThere) {
  const Workspace toy;
  ASSERT_EQ(run_process(engine_command(toy)).status, 0);
  const std::string results = toy.results(), of_models = means_csv(toy);
  const auto contents = toy.artefacts();
  for (const auto& [signal, status] : {std::pair(SIGINT, 130), {SIGTERM, 130}, {SIGKILL, 128 + SIGKILL}}) {
    toy.forget_everything();
    EXPECT_EQ(run_process(with_signal_at_rename(engine_command(toy, {"1"}), "5 after", signal)).status,
              status);
    const std::size_t stored = toy.artefacts().size();
    EXPECT_GT(stored, 0U);
    EXPECT_FALSE(fs::exists(toy.out() / "results.csv"));
    ASSERT_EQ(run_process(engine_command(toy)).status, 0);
    EXPECT_EQ(toy.computed(), contents.size() - stored);
    EXPECT_EQ(toy.results(), results);
    EXPECT_EQ(means_csv(toy), of_models);
    EXPECT_EQ(toy.artefacts(), contents);
    EXPECT_THAT(toy.left_over(), IsEmpty());
  }
}

TEST(Engine, ABadItemCostsItselfAlone) {
  const Workspace toy(kMeshesOnly);
  toy.write("data set/Meshes/2.off", "OFF\n1 2\n");
  const Outcome run = run_process(engine_command(toy));
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(lines_with(run.err, "error: 2: mesh: "), SizeIs(1)) << run.err;
  EXPECT_THAT(lines_with(toy.results(), "meshes,1,"), SizeIs(2));
}

// In one line, before anything is written.
TEST(Engine, WhatItCannotDoIsRefused) {
  const Workspace toy;
  const auto refused = [&](const std::vector<std::string>& words) {
    const Outcome run = run_process(words);
    EXPECT_EQ(run.status, 2) << run.err;
    EXPECT_THAT(lines_with(run.err, ""), SizeIs(1)) << run.err;
    EXPECT_FALSE(fs::exists(toy.cache()) || fs::exists(toy.out()));
    return run.err;
  };
  EXPECT_THAT(refused({SALBENCH_ENGINE}), HasSubstr("Usage: salbench-engine CONFIG DATA CACHE OUT"));
  EXPECT_THAT(refused(engine_command(toy, {"2", "3"})), HasSubstr("Usage: "));
  for (const char* threads : {"0", "many", "-1", "2000"})
    EXPECT_THAT(refused(engine_command(toy, {threads})), HasSubstr(std::string("THREADS is ") + threads));
  toy.configure("models: {PS: , MINE: {command: \"cp {mesh} {out}\"}}\n");
  EXPECT_THAT(refused(engine_command(toy)), HasSubstr("models.MINE: a command needs the command salbench "));
  toy.configure("dataset: {layout: sal3d}\nmodels: {PS: }\n");
  EXPECT_THAT(refused(engine_command(toy)), HasSubstr("the layout 'sal3d' needs the command salbench "));
  toy.configure("models: {NOSUCH: }\n");
  EXPECT_THAT(refused(engine_command(toy)), HasSubstr("toy.yaml:1: "));
}

TEST(Engine, AFolderThatCannotBeMadeIsNamed) {
  const Workspace toy(kMeshesOnly);
  toy.write("cache", "");
  const Outcome run = run_process(engine_command(toy));
  EXPECT_EQ(run.status, 3);
  EXPECT_THAT(lines_with(run.err, "error: "), testing::ElementsAre(HasSubstr(toy.cache().string())));
}

}  // namespace
}  // namespace salbench
