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

#include "io/file.h"
#include "io/table.h"
#include "stages/core/rng.h"
#include "stages/scan/scan.h"
#include "tests/e2e/workspace.h"
#include "tests/support/cache_files.h"
#include "tests/support/job_counts.h"
#include "tests/support/processes.h"
#include "tests/support/toy_data.h"

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
  const auto contents = toy.artefacts();

  Rng rng(2016, "kills", "");
  int killed = 0;
  const char* wish = std::getenv("SALBENCH_FAULTS");
  const int held_up =
      wish != nullptr && std::string_view(wish) == "all" ? 100 : 3;  // no quicker than the kill
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
    EXPECT_EQ(toy.artefacts(), contents);
    EXPECT_THAT(toy.left_over(), IsEmpty());
    EXPECT_THAT(lines_with(again.err, toy.cache().string()), IsEmpty()) << "a complaint about an artefact";
  }
  EXPECT_GE(killed, held_up);
}

// Every moment at which a file comes into being, hit from either side: what has its name is not computed
// again, and of what has not, nothing is used. By the native program, which is quick.
TEST(Interruption, KilledAtEachRenameNothingIsLostThatHadItsName) {
  const Workspace toy(kMeshesOnly);
  const std::vector<std::string> command = {SALBENCH_ENGINE,      toy.config().string(), toy.data().string(),
                                            toy.cache().string(), toy.out().string(),    "1"};
  ASSERT_EQ(run_process(command).status, 0);
  const std::string results = toy.results(), means = read_file(toy.out() / "means.csv");
  const auto contents = toy.artefacts();
  for (const char* side : {"before", "after"}) {
    for (std::size_t at = 1;; ++at) {
      SCOPED_TRACE(fmt::format("{} rename {}", side, at));
      toy.forget_everything();
      const Outcome killed =
          run_process(with_signal_at_rename(command, fmt::format("{} {}", at, side), SIGKILL));
      if (killed.status == 0) {
        EXPECT_GT(at, 6U) << "segments and tables";
        break;
      }
      ASSERT_EQ(killed.status, 128 + SIGKILL) << killed.err;
      const std::size_t stored = toy.artefacts().size();
      const Outcome again = run_process(command);
      ASSERT_EQ(again.status, 0) << again.err;
      EXPECT_EQ(toy.computed(), contents.size() - stored);
      EXPECT_EQ(toy.results(), results);
      EXPECT_EQ(read_file(toy.out() / "means.csv"), means);
      EXPECT_EQ(toy.artefacts(), contents);
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

TEST(Interruption, ASignalEndsTheRunInOrderAndTheLinePrintedResumesIt) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string results = toy.results();
  for (const int signal : {SIGINT, SIGTERM}) {
    toy.forget_everything();
    auto claim = claim_of_second_mesh(toy);
    Process process(toy.command("run"));
    ASSERT_TRUE(toy.reached_by(process, 20));
    process.send(signal);
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
}

// Two of five meshes are done: of the items that were finished the scores are final, and are shown.
TEST(Interruption, HalfWayThereAreFinalScoresOfTheItemsThatWereFinished) {
  const Workspace toy;
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

// A data set whose files processes of their own read.
TEST(Interruption, KilledAmidImportsNoProcessIsLeft) {
  const Workspace toy;
  const std::string own = toy.write("own.py", R"(from salbench.datasets import Item, match, mesh

def items(root):
    return [Item(one.item, [one.path], truth=False) for one in match(root, "Meshes/{item}.off")]

def read(item):
    return mesh(item.files[0])
)")
                              .string();
  toy.configure(fmt::format(
      "dataset: {{scans: false, layout: '{}', participants: simulated}}\nmodels: {{PS: , RS: }}\n", own));
  ASSERT_EQ(toy.salbench("run").status, 0);
  const auto contents = toy.artefacts();
  toy.forget_everything();
  const std::string mark = "SALBENCH_TEST_MARK=" + own;  // seen in the environment of its processes
  std::vector<std::string> command = with_signal_at_rename(toy.command("run"), "3 after", SIGKILL);
  command.insert(command.begin() + 1, mark);
  const Outcome killed = run_process(command);
  EXPECT_EQ(killed.status, 128 + SIGKILL) << killed.err;
  EXPECT_TRUE(soon([&] { return processes_with(mark, "environ").empty(); }));
  const Outcome resumed = toy.salbench("run");
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_LT(toy.computed(), contents.size());
  EXPECT_EQ(toy.artefacts(), contents);
  EXPECT_THAT(toy.left_over(), IsEmpty());
}

TEST(Interruption, KilledOrInterruptedAnExportHasNoName) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const fs::path exports = toy / "exports";
  fs::create_directories(exports);
  const std::vector<std::string> command = toy.command("export", {"--to", (exports / "toy.h5").string()});
  const auto files = [&] {
    std::vector<fs::path> paths;
    for (const FolderEntry& entry : list_folder(exports)) paths.push_back(entry.path);
    return paths;
  };
  // All is in the cache: the first rename is that of the export.
  ASSERT_EQ(run_process(with_signal_at_rename(command, "1 before", SIGKILL)).status, 128 + SIGKILL);
  std::vector<fs::path> abandoned;
  visit_abandoned(exports, [&](const fs::path& file) { abandoned.push_back(file); });
  EXPECT_THAT(abandoned, SizeIs(1));
  EXPECT_EQ(abandoned, files());
  fs::remove(abandoned.at(0));

  // Interrupted where another process has claimed what it is to compute again.
  damage(toy.cache(), "scan", "2_5");
  const auto claim = claim_of_second_mesh(toy);
  Process process(command);
  ASSERT_TRUE(toy.tries_to_claim(process, 2));
  process.send(SIGINT);
  const Outcome ended = process.wait();
  EXPECT_EQ(ended.status, 130) << ended.err;
  EXPECT_THAT(lines_with(ended.err, " export "), SizeIs(1));
  EXPECT_THAT(files(), IsEmpty());
}

}  // namespace
}  // namespace salbench
