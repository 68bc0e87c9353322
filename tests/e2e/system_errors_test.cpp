// SPDX-License-Identifier: GPL-3.0-or-later
// A refusal of the system is neither damage to the cache nor the user's fault, and a defect of the program is
// called one.
#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/e2e/workspace.h"
#include "tests/support/cache_files.h"
#include "tests/support/job_counts.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

struct SystemError {
  const char* name;
  int number;
  const char* said;
};
void PrintTo(const SystemError& error, std::ostream* out) { *out << error.name; }

class SystemErrors : public testing::TestWithParam<SystemError> {
 protected:
  void SetUp() override { ASSERT_EQ(toy_.salbench("run").status, 0); }

  // One error names what the system said; afterwards everything is there as before.
  void expect_refusal(const std::string& part) {
    const auto contents = toy_.contents();
    lose(toy_.cache(), "scores.PS");
    const Outcome run = run_process(in_trouble(
        "SALBENCH_AT_OPEN=" + std::to_string(GetParam().number) + " 0 " + part, toy_.command("run")));
    EXPECT_EQ(run.status, 3) << run.err;
    EXPECT_THAT(lines_with(run.err, "error: "), AllOf(SizeIs(1), Each(HasSubstr(GetParam().said))))
        << run.err;
    EXPECT_THAT(lines_with(run.err, "--cache"), IsEmpty()) << "no other folder helps: " << run.err;
    EXPECT_THAT(list_damaged(toy_.cache()), IsEmpty());
    const Outcome after = toy_.salbench("run");
    EXPECT_EQ(after.status, 0) << after.err;
    EXPECT_EQ(toy_.contents(), contents);
    EXPECT_EQ(toy_.computed(), JobCounts().of("scores.PS")) << "nothing else was removed";
  }

  Workspace toy_;
};

TEST_P(SystemErrors, OfAnArtefactThatIsReadAreNoDamage) { expect_refusal(".h5"); }

TEST_P(SystemErrors, OfAFolderThatIsListedDoNotEmptyIt) {
  expect_refusal("/" + segment_folder("1").string());
}

INSTANTIATE_TEST_SUITE_P(Errors, SystemErrors,
                         testing::Values(SystemError{"NoDescriptorLeft", EMFILE, "--threads"},
                                         SystemError{"InputOutputError", EIO, "Input/output error"},
                                         SystemError{"StaleHandle", ESTALE, "Stale file handle"}),
                         [](const auto& test) { return test.param.name; });

TEST(SystemError, WhatCannotBeBroughtToTheDiskEndsTheCommandThatWroteIt) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const auto contents = toy.contents();
  // gc writes what is left of a segment before it removes that.
  for (const auto& command : {toy.command("run"), toy.command("gc", {"--stage", "scores.PS"})}) {
    const Outcome ended = run_process(in_trouble("SALBENCH_AT_SYNC=" + std::to_string(EIO), command));
    EXPECT_EQ(ended.status, 3) << ended.err;
    EXPECT_THAT(lines_with(ended.err, "error: "), AllOf(SizeIs(1), Each(HasSubstr("Input/output error"))));
  }
  EXPECT_EQ(toy.contents(), contents) << "nothing was removed";
}

TEST(SystemError, OneInterruptedCallIsMadeAgain) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  lose(toy.cache(), "scores.PS");
  const Outcome run =
      run_process(in_trouble("SALBENCH_AT_OPEN=" + std::to_string(EINTR) + " 1 .h5", toy.command("run")));
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(lines_with(run.err, ".h5"), IsEmpty());
  EXPECT_EQ(toy.computed(), JobCounts().of("scores.PS"));
}

TEST(SystemError, AFewFileDescriptorsAreEnough) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string results = toy.results();
  toy.forget_everything();
  std::string line = "ulimit -n 64; exec";
  for (const std::string& word : toy.command("run", {"--threads", "8"})) line += " '" + word + "'";
  const Outcome run = run_process({"/bin/sh", "-c", line});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(toy.results(), results);
}

TEST(SystemError, ADefectIsNotTheUsersFault) {
  const Workspace toy;
  std::vector<std::string> command = toy.command("run");
  command.insert(command.begin(), {"/usr/bin/env", "LD_PRELOAD=" SALBENCH_NO_EMBREE});
  const Outcome run = run_process(command);
  EXPECT_EQ(run.status, 70) << run.err;
  EXPECT_THAT(lines_with(run.err, "error: 1_3: scan: a defect of salbench, please report it: Embree"),
              SizeIs(1))
      << run.err;
  EXPECT_THAT(lines_with(toy.results(), "meshes,1,"), SizeIs(2)) << "the other items go on";
}

TEST(SystemError, MemoryThatRunsOutForAFileCostsItsItemAlone) {
  const Workspace toy(kMeshesOnly);
  // A header that announces ten million vertices, 240 MB, and the room in the file for them.
  std::string mesh = "OFF\n10000000 1 0\n";
  for (int i = 0; i < 10'000'000; ++i) mesh += "0 0 0\n";
  toy.write("data set/Meshes/3.off", mesh);
  std::string line = "ulimit -v 340000; exec";
  for (const std::string& word : toy.without_conclusions(toy.command("run", {"--threads", "1"})))
    line += " '" + word + "'";
  const Outcome run = run_process({"/bin/sh", "-c", line});
  EXPECT_EQ(run.status, 1) << run.err;
  EXPECT_THAT(
      lines_with(run.err, "error: 3: mesh: " + (toy.data() / "Meshes/3.off").string() + ": no memory for"),
      SizeIs(1))
      << run.err;
  EXPECT_THAT(lines_with(toy.results(), "meshes,1,"), SizeIs(2)) << "the other items go on";
}

// --- pipes and signals ----------------------------------------------------------------------------------

TEST(Pipes, OfADataSetAreNamedAndNeverWaitedFor) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(::mkfifo((toy.data() / "Meshes/3.off").c_str(), 0600), 0);
  EXPECT_EQ(toy.salbench("plan").status, 0);
  const Outcome run = toy.salbench("run");
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(lines_with(run.err, "error: 3: mesh: "),
              AllOf(SizeIs(1), Each(HasSubstr("not a regular file"))));
  EXPECT_THAT(lines_with(toy.results(), "meshes,1,"), SizeIs(2));
}

TEST(Pipes, InPlaceOfAConfigurationOrATableAreRefused) {
  const Workspace toy(kMeshesOnly);
  const fs::path pipe = toy / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const Outcome table = toy.salbench("plan", {"--reference", pipe.string()});
  EXPECT_EQ(table.status, 2);
  EXPECT_THAT(table.err, HasSubstr("pipe: is not a regular file"));
  fs::remove(toy.config());
  ASSERT_EQ(::mkfifo(toy.config().c_str(), 0600), 0);
  const Outcome config = toy.salbench("plan");
  EXPECT_EQ(config.status, 2);
  EXPECT_THAT(config.err, HasSubstr("toy.yaml: is not a regular file"));
}

class OneSignal : public testing::TestWithParam<const char*> {};

// The command hangs in the opening of a file, as it does on a dead network file system.
TEST_P(OneSignal, EndsACommandAtOnceBeforeItsWorkBegins) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run").status, 0);
  const auto contents = toy.contents();
  for (const int signal : {SIGINT, SIGTERM}) {
    const fs::path held = toy / ("held_by_" + std::to_string(signal));
    Process process(in_trouble("SALBENCH_AT_OPEN=hold " + held.string() + " 2.off",
                               {SALBENCH_PROGRAM, GetParam(), toy.config().string(), "--data",
                                toy.data().string(), "--cache", toy.cache().string()}));
    ASSERT_TRUE(wait_until(process, [&] { return fs::exists(held); }));
    process.send(signal);
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.status, 130) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("To go on:"));
  }
  EXPECT_EQ(toy.contents(), contents);
}
INSTANTIATE_TEST_SUITE_P(Commands, OneSignal, testing::Values("run", "plan", "gc"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace salbench
