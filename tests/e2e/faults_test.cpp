// SPDX-License-Identifier: GPL-3.0-or-later
// Damage of every kind, and accidents around a run. A short version by default; with SALBENCH_FAULTS=all
// (scripts/check faults) every length, every byte and 200 kills.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include "cache/folder_store.h"
#include "cache/layout.h"
#include "stages/core/rng.h"
#include "tests/e2e/workspace.h"
#include "tests/support/cache_files.h"
#include "tests/support/job_counts.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::SizeIs;

bool all_faults() {
  const char* wish = std::getenv("SALBENCH_FAULTS");
  return wish != nullptr && std::string_view(wish) == "all";
}

// --- damaged artefacts ------------------------------------------------------------------------------------

// A copy of one artefact, alone in a cache of its own.
class LoneArtefact {
 public:
  explicit LoneArtefact(const ArtefactFile& original) : stage_(original.stage), key_(original.name.key) {
    file_ = folder_ / shard_of(stage_, key_) / original.path.filename();
    fs::create_directories(file_.parent_path());
    fs::copy_file(original.path, file_);
  }
  const fs::path& file() const { return file_; }
  bool is_read_as_valid() const {
    return FolderStore(folder_.path(), Access::read_only).load(stage_, key_).has_value();
  }

 private:
  TemporaryFolder folder_;
  std::string stage_;
  Digest key_;
  fs::path file_;
};

struct Tally {
  std::size_t tried = 0, valid = 0;
};

Tally cut_short(const ArtefactFile& original, std::size_t stride) {
  const LoneArtefact artefact(original);
  Tally tally;
  for (std::size_t cut = 1; cut <= original.name.size; cut += stride) {  // shorter and shorter, to nothing
    fs::resize_file(artefact.file(), original.name.size - cut);
    tally.valid += artefact.is_read_as_valid() ? 1 : 0;
    ++tally.tried;
  }
  return tally;
}

// One seeded bit of each byte, set back before the next.
Tally flip_bytes(const ArtefactFile& original, std::size_t stride) {
  const LoneArtefact artefact(original);
  EXPECT_TRUE(artefact.is_read_as_valid());
  std::fstream file(artefact.file(), std::ios::in | std::ios::out | std::ios::binary);
  const auto put = [&](std::size_t at, int byte) {
    file.seekp(static_cast<std::streamoff>(at));
    file.put(static_cast<char>(byte)).flush();
  };
  Rng rng(2016, "flips", original.stage);
  Tally tally;
  for (std::size_t at = 0; at < original.name.size; at += stride) {
    file.seekg(static_cast<std::streamoff>(at));
    const int byte = file.get();
    put(at, byte ^ (1 << rng.below(8)));
    tally.valid += artefact.is_read_as_valid() ? 1 : 0;
    ++tally.tried;
    put(at, byte);
  }
  EXPECT_TRUE(artefact.is_read_as_valid());
  return tally;
}

TEST(Faults, NoDamagedArtefactOfAnyKindIsReadAsValid) {
  const Workspace toy("scan: {step_degrees: 1}\nmodels: {PS: , HS: }\n");
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::vector<ArtefactFile> artefacts = artefacts_of(toy.cache());
  const std::size_t stride = all_faults() ? 1 : 499;
  const auto level = spdlog::get_level();
  spdlog::set_level(spdlog::level::off);  // each is named in a warning
  Tally lengths, bytes;
  for (const char* stage : {"mesh", "ground_truth", "normals", "scan", "surface", "fpfh", "map.PS",
                            "reference", "scores.PS", "score_table.PS", "curve.HS"}) {
    const auto found = std::find_if(artefacts.begin(), artefacts.end(),
                                    [&](const ArtefactFile& file) { return file.stage == stage; });
    ASSERT_NE(found, artefacts.end()) << stage;
    const Tally cut = cut_short(*found, stride), flipped = flip_bytes(*found, stride);
    fmt::print("{:14}: {} of {} truncations, {} of {} flipped bytes read as valid\n", stage, cut.valid,
               cut.tried, flipped.valid, flipped.tried);
    EXPECT_EQ(cut.valid + flipped.valid, 0U) << stage;
    EXPECT_GT(std::min(cut.tried, flipped.tried), 3U);
  }
  spdlog::set_level(level);
}

// --- kills ------------------------------------------------------------------------------------------------

TEST(Faults, RunsKilledAtSeededMomentsComeToTheSameResults) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::size_t all = toy.artefacts().size();
  const std::string results = toy.results(), summary = toy.summary();

  const int kills = all_faults() ? 200 : 4;
  Rng rng(2016, "moments", "");
  int identical = 0, at_work = 0;
  for (int trial = 0; trial < kills; ++trial) {
    toy.forget_everything();
    // Every second run lacks a mesh that the test has claimed: it cannot be quicker than the kill.
    auto claim = trial % 2 == 0 ? toy.claim_family("2") : nullptr;
    const std::size_t artefacts = rng.below(claim ? JobCounts(kToyConfig, 1).before_reference() : all);
    {
      Process process(toy.command("run"));
      toy.reached_by(process, artefacts, std::chrono::microseconds(rng.below(20000)));
      process.send(SIGKILL);
      at_work += process.wait().status == 128 + SIGKILL ? 1 : 0;
    }
    claim.reset();
    const Outcome resumed = toy.salbench("run");
    identical += resumed.status == 0 && toy.results() == results && toy.summary() == summary ? 1 : 0;
  }
  fmt::print("{} of {} identical ({} were killed at work)\n", identical, kills, at_work);
  EXPECT_EQ(identical, kills);
  EXPECT_GE(at_work, kills / 2);
}

// Every moment at which a file comes into being, hit from either side: what has its name is not computed
// again, and of what has not, nothing is used.
TEST(Faults, RunsKilledAtEachRenameLoseNothingThatHadItsName) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string results = toy.results(), summary = toy.summary();
  const auto contents = toy.contents();
  int kills = 0;
  const auto is_killed = [&](int at, const char* side) {
    toy.forget_everything();
    const Outcome run = run_process(with_signal_at_rename(toy.command("run", {"--threads", "1"}),
                                                          fmt::format("{} {}", at, side), SIGKILL));
    EXPECT_THAT(run.status, testing::AnyOf(0, 128 + SIGKILL)) << run.err;
    return run.status != 0;
  };
  for (const char* side : {"before", "after"}) {
    for (int at = 1; is_killed(at, side); ++at, ++kills) {
      SCOPED_TRACE(fmt::format("{} rename {}", side, at));
      const std::size_t stored = toy.contents().size();
      const Outcome again = toy.salbench("run");
      ASSERT_EQ(again.status, 0) << again.err;
      EXPECT_EQ(toy.computed(), contents.size() - stored);
      EXPECT_EQ(toy.results(), results);
      EXPECT_EQ(toy.summary(), summary);
      EXPECT_EQ(toy.contents(), contents);
      EXPECT_THAT(toy.left_over(), testing::IsEmpty());
    }
  }
  fmt::print("killed before and after each of {} renames\n", kills / 2);
  EXPECT_GT(kills / 2, static_cast<int>(contents.size()));  // the artefacts' and the tables'
}

// --- accidents --------------------------------------------------------------------------------------------

TEST(Faults, ACacheRemovedDuringARunCostsTheWorkAndNothingElse) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string results = toy.results();
  for (const std::size_t reached : {1U, 40U, 150U}) {
    toy.forget_everything();
    fs::remove_all(toy / "away");
    Process process(toy.command("run"));
    ASSERT_TRUE(wait_until(process, [&] { return toy.artefacts().size() >= reached; }));
    fs::rename(toy.cache(), toy / "away");
    const Outcome ended = process.wait();
    if (ended.status == 0)
      EXPECT_EQ(toy.results(), results);
    else  // it went in the middle of storing something
      EXPECT_TRUE(ended.status == 3 && lines_with(ended.err, "error: ").size() == 1) << ended.err;
    ASSERT_EQ(toy.salbench("run").status, 0);
    EXPECT_EQ(toy.results(), results);
    EXPECT_EQ(run_process({SALBENCH_PROGRAM, "verify", "--cache", toy.cache().string()}).status, 0);
  }
}

TEST(Faults, AFewFileDescriptorsAreEnough) {
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

TEST(Faults, TheTimesOfFilesNeverMatter) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string results = toy.results();
  const auto now = fs::file_time_type::clock::now();
  const std::chrono::hours fifty_years(50 * 365 * 24);
  for (const auto& [cache_time, data_time] :
       {std::pair(now - fifty_years, now), std::pair(now, now - fifty_years),
        std::pair(now + fifty_years, now - fifty_years), std::pair(now - fifty_years, now + fifty_years)}) {
    for (const fs::path& file : toy.artefacts()) fs::last_write_time(file, cache_time);
    for (const auto& entry : fs::recursive_directory_iterator(toy.data()))
      if (entry.is_regular_file()) fs::last_write_time(entry.path(), data_time);
    ASSERT_EQ(toy.salbench("run").status, 0);
    EXPECT_EQ(toy.computed(), 0);
    EXPECT_EQ(toy.results(), results);
  }
}

}  // namespace
}  // namespace salbench
