// SPDX-License-Identifier: GPL-3.0-or-later
// Several processes over one cache: they share the work, and what comes of it is what one process makes.
#include <csignal>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "tests/e2e/workspace.h"
#include "tests/support/job_counts.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

constexpr int kProcesses = 4, kMeshes = 3;  // meshes with those of add_more_meshes

std::string out_of(const Workspace& toy, int process) {
  return (toy / ("out" + std::to_string(process))).string();
}

// None equals another, whose artefacts it would share.
void add_more_meshes(const Workspace& toy) {
  for (int k = 3; k <= kMeshes; ++k)
    write_toy_item(toy.data(), std::to_string(k), shapes::bumpy_sphere(2, 0.02 + 0.05 * k));
}

std::size_t computed_by(const fs::path& record) {
  const auto line = lines_with(read_file(record), "artefacts_computed: ");
  return std::stoul(line.at(0).substr(line[0].find(' ')));
}

TEST(Processes, FourAtOnceDoTheWorkOfOneAndComeToTheSameBytes) {
  const Workspace toy;
  add_more_meshes(toy);
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string results = toy.results(), summary = toy.summary();
  const auto contents = toy.artefacts();
  toy.forget_everything();

  std::vector<std::unique_ptr<Process>> processes;
  for (int p = 0; p < kProcesses; ++p)
    processes.push_back(
        std::make_unique<Process>(toy.command("run", {"--threads", "1", "--out", out_of(toy, p)})));
  std::size_t computed = 0;
  for (int p = 0; p < kProcesses; ++p) {
    const Outcome run = processes[static_cast<std::size_t>(p)]->wait();
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(read_file(fs::path(out_of(toy, p)) / "results.csv"), results);
    EXPECT_EQ(read_file(fs::path(out_of(toy, p)) / "summary.csv"), summary);
    computed += computed_by(fs::path(out_of(toy, p)) / "run.yaml");
  }
  EXPECT_EQ(toy.artefacts(), contents);
  EXPECT_EQ(computed, contents.size()) << "some artefact was computed twice";
  EXPECT_THAT(toy.left_over(), IsEmpty());
}

// This test stands for the other process: it holds what the first mesh's family is claimed by.
TEST(Processes, WhatAnotherOneHasClaimedIsLeftUntilItGivesItUp) {
  const Workspace toy;
  auto claim = toy.claim_family("1");
  ASSERT_NE(claim, nullptr);
  Process run(toy.command("run"));
  const std::size_t of_second_mesh = JobCounts(kToyConfig, 1).before_reference();
  ASSERT_TRUE(wait_until(run, [&] { return toy.artefacts().size() >= of_second_mesh; }));
  ASSERT_TRUE(toy.tries_to_claim(run, 2)) << "with nothing else to do, it must ask for the first mesh";
  EXPECT_THAT(toy.artefacts(), SizeIs(of_second_mesh)) << "of the second mesh, before matching";
  for (const std::string& line : toy.artefacts()) EXPECT_THAT(line, HasSubstr("/2"));
  Process interrupted(toy.command("run", {"--out", out_of(toy, 1)}));
  ASSERT_TRUE(toy.tries_to_claim(interrupted, 5)) << "it must be waiting, too";
  interrupted.send(SIGINT);
  EXPECT_EQ(interrupted.wait().status, 130);
  claim.reset();
  const Outcome outcome = run.wait();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(toy.computed(), toy.artefacts().size());
}

TEST(Processes, AKilledOneHoldsUpNoOther) {
  const Workspace toy;
  add_more_meshes(toy);
  // Stopped while it stores what it made of a mesh, so with its mesh claimed.
  Process victim(with_signal_at_rename(toy.command("run", {"--threads", "1", "--out", out_of(toy, 1)}),
                                       "4 before", SIGSTOP));
  ASSERT_TRUE(wait_until(victim, [&] { return victim.stopped(); }));
  Process survivor(toy.command("run", {"--threads", "1", "--out", out_of(toy, 2)}));
  ASSERT_TRUE(toy.tries_to_claim(survivor, 3 * kMeshes)) << "after one try for each mesh it must be waiting";
  victim.send(SIGKILL);
  const Outcome run = survivor.wait();
  EXPECT_EQ(run.status, 0) << run.err;
  const std::string results = read_file(fs::path(out_of(toy, 2)) / "results.csv");
  toy.forget_everything();
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.results(), results);
}

// Families are claimed by the content of their mesh: one of the two comes in a second round of the reference,
// and nothing else is begun before.
TEST(Processes, TwoMeshesOfOneContentAreWorkedOnOneAfterTheOther) {
  const Workspace toy;
  for (const char* file : {"Meshes/%.off", "Distributions/%.val", "RawData/%_0.pid", "RawData/%_1.pid"}) {
    const auto named = [&](const char* mesh) {
      return toy.data() / std::string(file).replace(std::string(file).find('%'), 1, mesh);
    };
    fs::copy(named("1"), named("3"));
  }
  const Outcome run = toy.salbench("run");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(lines_with(run.err, "reference: "), SizeIs(1)) << run.err;
  EXPECT_THAT(lines_with(run.err, "maps: "), IsEmpty()) << run.err;
  EXPECT_THAT(lines_with(run.err, "evaluation: "), SizeIs(1)) << run.err;
}

TEST(Shards, TogetherDoTheWorkOfOneRunWhichThenOnlyMatchesAndScores) {
  const Workspace toy;
  add_more_meshes(toy);
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string results = toy.results();
  const auto contents = toy.artefacts();
  toy.forget_everything();

  std::size_t computed = 0;
  for (const char* shard : {"1/3", "2/3", "3/3"}) {
    const Outcome run = toy.salbench("run", {"--shard", shard});
    ASSERT_EQ(run.status, 0) << run.err;
    const std::string name = "shard_" + std::string(1, shard[0]) + "_of_3.yaml";
    EXPECT_THAT(read_file(toy.out() / name), HasSubstr("shard: " + std::string(shard) + "\n"));
    EXPECT_EQ(computed_by(toy.out() / name), JobCounts(kToyConfig, kMeshes / 3).before_reference());
    computed += computed_by(toy.out() / name);
    EXPECT_THAT(toy.salbench("plan", {"--shard", shard}).out, HasSubstr("\n0 jobs to do"));
  }
  EXPECT_FALSE(fs::exists(toy.out() / "results.csv") || fs::exists(toy.out() / "run.yaml"));
  EXPECT_THAT(toy.artefacts(), Each(Not(HasSubstr("matched."))));
  EXPECT_EQ(computed, toy.artefacts().size());

  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.computed() + computed, contents.size());
  EXPECT_EQ(toy.results(), results);
  EXPECT_EQ(toy.artefacts(), contents);
}

TEST(Shards, WithAGivenReferenceLeaveNothingButTheTablesToDo) {
  const Workspace toy;
  std::string csv = "GS\n";
  for (int bin = 0; bin < 100; ++bin) csv += "1\n";
  const std::string reference = toy.write("reference.csv", csv).string();
  for (const char* shard : {"1/2", "2/2"})
    ASSERT_EQ(toy.salbench("run", {"--shard", shard, "--reference", reference}).status, 0);
  EXPECT_THAT(toy.artefacts("scores.PS"), SizeIs(JobCounts().of("scores.PS")));
  ASSERT_EQ(toy.salbench("run", {"--reference", reference}).status, 0);
  const JobCounts jobs;
  EXPECT_EQ(toy.computed(), jobs.of_the_data_set() - jobs.of("reference"))
      << "the mean histograms of the models, and their tables of scores";
}

// Either goes on from the cache of the other.
TEST(Processes, TheEngineWithoutPythonComesToTheSame) {
  const Workspace toy;
  const auto engine = [&](const char* out) {
    const Outcome run = run_process({SALBENCH_ENGINE, toy.config().string(), toy.data().string(),
                                     toy.cache().string(), (toy / out).string()});
    EXPECT_EQ(run.status, 0) << run.err;
    for (const char* table : {"results.csv", "means.csv"})
      EXPECT_EQ(read_file(toy / out / table), read_file(toy.out() / table)) << table;
  };
  ASSERT_EQ(toy.salbench("run").status, 0);
  const auto contents = toy.artefacts();
  engine("again");
  EXPECT_THAT(read_file(toy / "again/run.yaml"), HasSubstr("\nartefacts_computed: 0\n"));
  fs::remove_all(toy.cache());
  engine("anew");
  EXPECT_EQ(toy.artefacts(), contents);
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.computed(), 0U);
}

TEST(Hdf5Library, IsCalledByOneThreadAtATimeWhereItIsNotThreadSafe) {
  const Workspace toy;
  const auto run = [&](const std::vector<std::string>& preloaded) {
    std::vector<std::string> words = {SALBENCH_ENGINE,      toy.config().string(), toy.data().string(),
                                      toy.cache().string(), toy.out().string(),    "4"};
    words.insert(words.begin(), preloaded.begin(), preloaded.end());
    const Outcome ended = run_process(words);
    EXPECT_EQ(ended.status, 0) << ended.err;
    return toy.results();
  };
  const std::string results = run({});
  toy.forget_everything();
  EXPECT_EQ(run({"/usr/bin/env", "LD_PRELOAD=" SALBENCH_WATCH_HDF5}), results);
}

}  // namespace
}  // namespace salbench
