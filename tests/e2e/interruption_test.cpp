// SPDX-License-Identifier: GPL-3.0-or-later
// Whatever ends a run, the next one goes on from there and comes to the same results. A few kills by default;
// 200 with SALBENCH_FAULTS=all (scripts/check faults).
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <memory>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/table.h"
#include "stages/core/rng.h"
#include "stages/scan/scan.h"
#include "tests/e2e/workspace.h"
#include "tests/support/job_counts.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// Of the second mesh, by another process, which is the test: a run can then not come to its end by itself.
std::unique_ptr<Claim> claim_of_second_mesh(const Workspace& toy) { return toy.claim_family("2"); }
// Artefacts that such a run can store.
std::size_t beside_second_mesh() { return JobCounts(kToyConfig, 1).before_reference(); }

TEST(Interruption, KilledAtAnyMomentTheNextRunComesToTheSameBytes) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string results = toy.results(), summary = toy.summary();
  const auto contents = toy.contents();

  Rng rng(2016, "kills", "");
  int killed = 0;
  const char* wish = std::getenv("SALBENCH_FAULTS");
  const int held_up =
      wish != nullptr && std::string_view(wish) == "all" ? 100 : 6;  // no quicker than the kill
  for (int trial = 0; trial < 2 * held_up; ++trial) {
    toy.forget_everything();
    auto claim = trial < held_up ? claim_of_second_mesh(toy) : nullptr;
    const std::size_t artefacts = rng.below(2) * beside_second_mesh();
    const std::chrono::microseconds longer(rng.below(artefacts == 0 ? 400'000 : 4'000));
    SCOPED_TRACE(testing::Message() << "after " << artefacts << " artefacts and " << longer.count() << " us");
    {
      Process process(toy.command("run"));
      if (toy.reached_by(process, artefacts, longer)) {
        process.send(SIGKILL);
        killed += process.wait().status == 128 + SIGKILL ? 1 : 0;
      }
    }
    claim.reset();
    const Outcome again = toy.salbench("run");
    ASSERT_EQ(again.status, 0) << again.err;
    EXPECT_EQ(toy.results(), results);
    EXPECT_EQ(toy.summary(), summary);
    EXPECT_EQ(toy.contents(), contents);
    EXPECT_THAT(toy.left_over(), IsEmpty());
    EXPECT_THAT(lines_with(again.err, toy.cache().string()), IsEmpty()) << "a complaint about an artefact";
  }
  EXPECT_GE(killed, held_up);
}

// Every moment at which a file comes into being, hit from either side: what has its name is not computed
// again, and of what has not, nothing is used. Conclusions are drawn once all artefacts are there.
TEST(Interruption, KilledAtEachRenameNothingIsLostThatHadItsName) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string results = toy.results(), summary = toy.summary();
  const auto contents = toy.contents();
  const std::size_t files = toy.files().size();
  const auto command = [&](std::size_t at) {
    const std::vector<std::string> words = toy.command("run", {"--threads", "1"});
    return at <= files ? toy.without_conclusions(words) : words;
  };
  for (const char* side : {"before", "after"}) {
    for (std::size_t at = 1;; ++at) {
      SCOPED_TRACE(fmt::format("{} rename {}", side, at));
      toy.forget_everything();
      const Outcome killed =
          run_process(with_signal_at_rename(command(at), fmt::format("{} {}", at, side), SIGKILL));
      if (killed.status == 0) {
        EXPECT_GT(at, files + 1) << "segments and tables";
        break;
      }
      ASSERT_EQ(killed.status, 128 + SIGKILL) << killed.err;
      const std::size_t stored = toy.contents().size();
      const Outcome again = run_process(command(at));
      ASSERT_EQ(again.status, 0) << again.err;
      EXPECT_EQ(toy.computed(), contents.size() - stored);
      EXPECT_EQ(toy.results(), results);
      if (at > files) {
        EXPECT_EQ(toy.summary(), summary);
      }
      EXPECT_EQ(toy.contents(), contents);
      EXPECT_THAT(toy.left_over(), IsEmpty());
    }
  }
}

// Leftovers of a process that was killed while it wrote, without the luck of hitting the moment.
TEST(Interruption, PartsOfFilesThatAKilledRunLeftAreRemoved) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run").status, 0);
  toy.write("cache/tmp/00c0ffee00c0ffee.salbench-part", "half an arte");
  toy.write("out/00c0ffee00c0ffee.salbench-part", "half a ta");
  EXPECT_THAT(toy.left_over(), SizeIs(2));
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_THAT(toy.left_over(), IsEmpty());
}

// A run from its own record, which stands in the folder that it writes to.
TEST(Interruption, KilledARunOfARecordGoesOnByTheSameLine) {
  const Workspace toy("dataset: {scans: false}\nseed: 7\nmodels: {RS: , MINE: {model: PS}}\n");
  ASSERT_EQ(toy.salbench("run", {"--items", "2"}).status, 0);
  const std::string results = toy.results();
  const std::vector<std::string> line = {SALBENCH_PROGRAM, "run", (toy.out() / "run.yaml").string(),
                                         "--quiet"};
  for (const char* moment : {"2 after", "4 after"}) {
    fs::remove_all(toy.cache());
    EXPECT_EQ(run_process(with_signal_at_rename(line, moment, SIGKILL)).status, 128 + SIGKILL);
    EXPECT_THAT(read_file(toy.out() / "run.yaml"), testing::StartsWith("# a run is under way, or was ended"));
    const Outcome ended = run_process(line);
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_EQ(toy.results(), results);
  }
}

// Its run.yaml is a comment: as a configuration it would be that of all defaults.
TEST(Interruption, ARecordOfVersion10ThatWasEndedStandsForNoConfiguration) {
  const Workspace toy(kMeshesOnly);
  const auto record = toy.write("out/run.yaml", "# a run is under way, or was ended before its end\n");
  const Outcome ended = run_process(
      {SALBENCH_PROGRAM, "run", record.string(), "--data", toy.data().string(), "--out", toy.out().string()});
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, HasSubstr("is the record of a run that was ended; name its configuration"));
  EXPECT_EQ(toy.salbench("run").status, 0);
}

TEST(Interruption, BeforeTheFirstScoreNoneOfAnEarlierRunIsLeft) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run").status, 0);
  fs::remove_all(toy.cache());
  const auto claim = claim_of_second_mesh(toy);
  Process process(toy.command("run"));
  ASSERT_TRUE(toy.reached_by(process, 2));
  process.send(SIGINT);
  const Outcome ended = process.wait();
  EXPECT_EQ(ended.status, 130) << ended.err;
  EXPECT_THAT(read_file(toy.out() / "run.yaml"), HasSubstr("results: partial, 0 of 2 shapes"));
  EXPECT_FALSE(fs::exists(toy.out() / "results.csv") || fs::exists(toy.out() / "conclusions.json"));
}

class Signal : public testing::TestWithParam<int> {};

TEST_P(Signal, EndsTheRunInOrderAndTheLinePrintedResumesIt) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string results = toy.results();
  toy.forget_everything();

  auto claim = claim_of_second_mesh(toy);
  Process process(toy.command("run"));
  ASSERT_TRUE(toy.reached_by(process, 20));
  process.send(GetParam());
  const Outcome ended = process.wait();
  claim.reset();
  EXPECT_EQ(ended.status, 130);
  EXPECT_FALSE(fs::exists(toy.out() / "results.csv"));

  const std::vector<std::string> line = lines_with(ended.err, " run ");
  ASSERT_THAT(line, SizeIs(1)) << ended.err;
  const Outcome resumed = run_process({"/bin/sh", "-c", line[0]});
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(toy.results(), results);
  EXPECT_THAT(toy.left_over(), IsEmpty());
}
INSTANTIATE_TEST_SUITE_P(Interruption, Signal, testing::Values(SIGINT, SIGTERM, SIGHUP),
                         [](const auto& test) { return std::string(::sigabbrev_np(test.param)); });

TEST(Interruption, WhatIgnoresTheEndOfItsTerminalGoesOn) {
  const Workspace toy;
  auto claim = claim_of_second_mesh(toy);
  std::vector<std::string> command = toy.command("run");
  command.insert(command.begin(), {"/bin/sh", "-c", "trap '' HUP; exec \"$0\" \"$@\""});  // as nohup
  Process process(command);
  ASSERT_TRUE(toy.reached_by(process, 20));
  process.send(SIGHUP);
  claim.reset();
  const Outcome outcome = process.wait();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

// Two of five meshes are done: of the items that were finished the scores are final, and are shown.
TEST(Interruption, HalfWayThereAreFinalScoresOfTheItemsThatWereFinished) {
  const Workspace toy("scan: {step_degrees: 1}\n");  // every model
  for (const char* mesh : {"3", "4", "5"})
    write_toy_item(toy.data(), mesh, shapes::bumpy_sphere(2, 0.1 * std::atoi(mesh)));
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::vector<std::string> complete = lines_with(toy.results(), ",");
  constexpr int kStored = 1 + 5 + 2 + 2;  // the cache's tag, what references are made of, these, two meshes
  const std::size_t shapes = 5 * (1 + kViews);
  EXPECT_THAT(toy.salbench("plan").out, HasSubstr("\nlast run: finished\n"));
  toy.forget_everything();

  const Outcome ended =
      run_process(with_signal_at_rename(toy.command("run"), std::to_string(kStored) + " after", SIGTERM));
  EXPECT_EQ(ended.status, 130) << ended.err;
  Table so_far = read_csv(toy.out() / "results.csv");
  EXPECT_THAT(so_far.remarks, testing::ElementsAre(testing::StartsWith("PARTIAL: ")));
  EXPECT_THAT(toy.results(), testing::StartsWith("dataset,item,class,view,model,"));
  so_far.remarks.clear();
  const std::vector<std::string> partial = lines_with(to_csv(so_far), ",");
  EXPECT_THAT(complete, testing::IsSupersetOf(partial));

  const std::string status = toy.salbench("plan").out;
  const std::size_t at = status.find("last run: partial, ");
  ASSERT_NE(at, std::string::npos) << status;
  const int finished = std::stoi(status.substr(at + std::strlen("last run: partial, ")));
  EXPECT_GE(finished, 1 + kViews);
  EXPECT_THAT(status, HasSubstr(" of " + std::to_string(shapes) + " shapes have all scores\n"));

  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(lines_with(toy.results(), ","), complete);
}

}  // namespace
}  // namespace salbench
