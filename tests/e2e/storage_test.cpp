// SPDX-License-Identifier: GPL-3.0-or-later
// Folders that cannot be written to, disks that are full, and files in the cache that rotted.
#include <chrono>
#include <fstream>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "cache/layout.h"
#include "io/file.h"
#include "tests/e2e/small_disk.h"
#include "tests/e2e/workspace.h"
#include "tests/support/cache_files.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

TEST(Storage, FoldersThatCannotBeMadeAreNamed) {
  const Workspace toy(kMeshesOnly);
  const std::string file = toy.write("a file", "").string();
  for (const std::string& folder : {file, file + "/below", std::string("/proc/nowhere/cache")}) {
    for (const char* option : {"--cache", "--out"}) {
      const Outcome run = toy.salbench("run", {option, folder});
      EXPECT_EQ(run.status, 3) << option << " " << folder;
      EXPECT_THAT(lines_with(run.err, "error: "),
                  AllOf(SizeIs(1), Each(AllOf(HasSubstr(folder), HasSubstr(option)))));
    }
  }
}

TEST(Storage, AFullDiskEndsTheRunAndWithMoreRoomItGoesOn) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string results = toy.results();
  fs::remove_all(toy.cache());
  const SmallDisk disk(toy.cache(), "size=300k");
  if (!disk.mounted()) GTEST_SKIP() << "mounting is not allowed here";
  const Outcome full = toy.salbench("run");
  EXPECT_EQ(full.status, 3);
  EXPECT_THAT(lines_with(full.err, "error: "),
              AllOf(SizeIs(1), Each(AllOf(HasSubstr(toy.cache().string()), HasSubstr("No space left")))))
      << full.err;
  const std::size_t kept = toy.artefacts().size();
  EXPECT_GT(kept, 5U);
  EXPECT_THAT(toy.left_over(), IsEmpty());

  ASSERT_TRUE(disk.resize("size=30m"));
  const Outcome more = toy.salbench("run");
  ASSERT_EQ(more.status, 0) << more.err;
  EXPECT_EQ(toy.computed() + kept, toy.artefacts().size());
  EXPECT_EQ(toy.results(), results);
}

TEST(Storage, ALimitOnFileSizesIsAFullDiskAndNoSignal) {
  const Workspace toy;
  std::string line = "ulimit -f 8; exec";  // 4 or 8 kB, which the larger artefacts pass
  for (const std::string& word : toy.command("run")) line += " '" + word + "'";
  const Outcome run = run_process({"/bin/sh", "-c", line});
  EXPECT_EQ(run.status, 3) << run.err;
  EXPECT_THAT(lines_with(run.err, "error: "), AllOf(SizeIs(1), Each(HasSubstr("File too large")))) << run.err;
  EXPECT_THAT(toy.left_over(), IsEmpty());
}

// --- a cache that others may only read -------------------------------------------------------------------

enum class ReadOnly { disk, permissions };
void PrintTo(ReadOnly how, std::ostream* out) { *out << (how == ReadOnly::disk ? "Disk" : "Permissions"); }

// A complete cache, pictures included, that the program cannot write to.
class ReadOnlyCache : public testing::TestWithParam<ReadOnly> {
 protected:
  void SetUp() override {
    if (GetParam() == ReadOnly::disk) disk_.emplace(toy_.cache(), "size=30m");
    if (disk_ && !disk_->mounted()) GTEST_SKIP() << "mounting is not allowed here";
    ASSERT_EQ(toy_.salbench("run").status, 0);
    ASSERT_EQ(toy_.salbench("export", {"--to", (toy_ / "all.h5").string(), "--pictures"}).status, 0);
    contents_ = toy_.contents();
    if (disk_)
      ASSERT_TRUE(disk_->make_read_only());
    else
      change_permissions(fs::perm_options::remove);
  }
  void TearDown() override {
    if (!disk_) change_permissions(fs::perm_options::add);
  }

  void change_permissions(fs::perm_options change) const {
    std::vector<fs::path> paths = {toy_.cache()};
    for (const auto& entry : fs::recursive_directory_iterator(toy_.cache())) paths.push_back(entry.path());
    for (const fs::path& path : paths) fs::permissions(path, fs::perms::owner_write, change);
  }

  // Permissions do not bind root, unless that capability is dropped.
  Outcome salbench(const std::string& verb, const std::vector<std::string>& further = {}) const {
    std::vector<std::string> words = toy_.command(verb, further);
    if (!disk_ && ::geteuid() == 0)
      words.insert(words.begin(),
                   {"/usr/bin/setpriv", "--bounding-set=-dac_override", "--inh-caps=-dac_override"});
    return run_process(words);
  }

  Workspace toy_{kMeshesOnly};
  std::optional<SmallDisk> disk_;
  std::vector<std::string> contents_;
};

TEST_P(ReadOnlyCache, ThatIsCompleteIsAllThatIsNeeded) {
  const std::string results = toy_.results();
  for (const std::vector<std::string>& call :
       {std::vector<std::string>{"run"},
        {"export", "--format", "maps", "--to", (toy_ / "maps").string()},
        {"export", "--to", (toy_ / "all.h5").string(), "--pictures"},
        {"export", "--to", (toy_ / "shapes").string(), "--format", "ply"},
        {"plan"}}) {
    const Outcome outcome = salbench(call[0], {call.begin() + 1, call.end()});
    EXPECT_EQ(outcome.status, 0) << call[0] << ": " << outcome.err;
    EXPECT_THAT(outcome.err, Not(HasSubstr(toy_.cache().string()))) << call[0];
  }
  EXPECT_EQ(run_process({SALBENCH_PROGRAM, "verify", "--cache", toy_.cache().string()}).status, 0);
  EXPECT_EQ(toy_.computed(), 0U);
  EXPECT_EQ(toy_.results(), results);
  EXPECT_EQ(toy_.contents(), contents_);
}

TEST_P(ReadOnlyCache, ThatSomethingIsToBeAddedToIsNamedBeforeTheWorkBegins) {
  const std::string results = toy_.results();
  toy_.configure("dataset: {scans: false}\nmodels: {PS: , RS: , CS: }\n");
  for (const std::vector<std::string>& call :
       {std::vector<std::string>{"run"},
        {"run", "--shard", "1/2"},
        {"export", "--format", "maps", "--to", (toy_ / "maps").string()},
        {"export", "--to", (toy_ / "all.h5").string()}}) {
    const Outcome outcome = salbench(call[0], {call.begin() + 1, call.end()});
    EXPECT_EQ(outcome.status, 3) << call[0];
    EXPECT_THAT(
        lines_with(outcome.err, "error: "),
        AllOf(SizeIs(1), Each(AllOf(HasSubstr(toy_.cache().string()), HasSubstr("cannot be written to"),
                                    testing::AnyOf(HasSubstr("choose another folder"),
                                                   HasSubstr("check its permissions"))))))
        << outcome.err;
  }
  EXPECT_EQ(toy_.results(), results);
  EXPECT_THAT(toy_.salbench("plan").out, HasSubstr("last run: finished")) << "the results of the run before";
}

TEST_P(ReadOnlyCache, ThatIsDamagedIsReadAsFarAsItGoes) {
  const fs::path damaged = file_with(toy_.cache(), "map.PS", "1");
  if (disk_) {
    ASSERT_TRUE(disk_->resize("size=30m"));
    fs::resize_file(damaged, 100);
    ASSERT_TRUE(disk_->make_read_only());
  } else {
    fs::permissions(damaged, fs::perms::owner_write, fs::perm_options::add);
    fs::resize_file(damaged, 100);
  }
  const Outcome plan = salbench("plan"), run = salbench("run");
  EXPECT_EQ(plan.status, 0) << plan.err;
  EXPECT_THAT(lines_with(plan.err, damaged.string()), SizeIs(1)) << plan.err;
  EXPECT_EQ(run.status, 3);
  EXPECT_THAT(lines_with(run.err, "error: "), SizeIs(1)) << run.err;
}
INSTANTIATE_TEST_SUITE_P(Storage, ReadOnlyCache, testing::Values(ReadOnly::disk, ReadOnly::permissions),
                         testing::PrintToStringParamName());

// Places in a segment: a byte of each is flipped.
std::uint64_t of_head(const Segment&, const fs::path&) { return 3; }
std::uint64_t of_table(const Segment&, const fs::path&) { return 100; }
std::uint64_t of_record(const Segment& segment, const fs::path&) { return segment.rows().back().at + 3; }
std::uint64_t of_arrays(const Segment& segment, const fs::path& file) {
  Bytes largest;
  for (const SegmentRow& row : segment.rows()) {
    std::optional<Artefact> artefact = segment.read(row, Segment::Part::all);
    for (PackedArray& array : artefact.value().arrays)
      for (Bytes& piece : array.pieces)
        if (piece.size() > largest.size()) largest = std::move(piece);
  }
  return read_file(file).find(
      std::string_view(reinterpret_cast<const char*>(largest.data()), largest.size()));
}
std::uint64_t of_end(const Segment&, const fs::path& file) { return fs::file_size(file) - 1; }

class FlippedBytes : public testing::TestWithParam<std::uint64_t (*)(const Segment&, const fs::path&)> {
 protected:
  void SetUp() override {
    ASSERT_EQ(toy_.salbench("run").status, 0);
    results_ = toy_.results();
    contents_ = toy_.contents();
    damaged_ = toy_.files();
    for (const fs::path& file : damaged_) flip_byte(file, GetParam()(*Segment::open(file), file));
  }
  Outcome verify() const {
    return run_process({SALBENCH_PROGRAM, "verify", "--cache", toy_.cache().string()});
  }
  // All was computed again, and comes out as before.
  void expect_restored() const {
    EXPECT_EQ(verify().status, 0) << verify().out;
    EXPECT_EQ(toy_.computed(), contents_.size());
    EXPECT_EQ(toy_.results(), results_);
    EXPECT_EQ(toy_.contents(), contents_);
    const Outcome after = toy_.salbench("run");
    EXPECT_EQ(after.status, 0);
    EXPECT_THAT(after.err, Not(HasSubstr(toy_.cache().string()))) << "warned again";
    EXPECT_EQ(toy_.computed(), 0U);
  }

  const Workspace toy_;
  std::string results_;
  std::vector<std::string> contents_;
  std::vector<fs::path> damaged_;
};

TEST_P(FlippedBytes, InEverySegmentAreFoundByARunWhichComputesThemAgain) {
  const Outcome run = toy_.salbench("run");
  ASSERT_EQ(run.status, 0) << run.err;
  for (const fs::path& file : damaged_)
    EXPECT_THAT(lines_with(run.err, file.string()),
                AllOf(SizeIs(1), Each(AllOf(HasSubstr("warning: "), HasSubstr("renamed to *.damaged")))));
  EXPECT_THAT(list_damaged(toy_.cache()), SizeIs(damaged_.size()));
  expect_restored();
  EXPECT_THAT(toy_.salbench("gc").out, HasSubstr(fmt::format(" {} damaged files", damaged_.size())));
  EXPECT_THAT(list_damaged(toy_.cache()), SizeIs(0));
}

TEST_P(FlippedBytes, InEverySegmentAreRemovedByGc) {
  const Outcome found = verify();
  EXPECT_EQ(found.status, 1);
  EXPECT_THAT(found.out, HasSubstr("run again, which computes what was damaged, or gc"));
  EXPECT_EQ(toy_.files(), damaged_);
  const Outcome gc = toy_.salbench("gc");
  ASSERT_EQ(gc.status, 0) << gc.err;
  EXPECT_THAT(gc.out, HasSubstr(fmt::format(" {} damaged files", damaged_.size())));
  EXPECT_EQ(verify().status, 0);
  EXPECT_THAT(toy_.files(), SizeIs(0));
  ASSERT_EQ(toy_.salbench("run").status, 0);
  expect_restored();
}
INSTANTIATE_TEST_SUITE_P(Storage, FlippedBytes,
                         testing::Values(of_head, of_table, of_record, of_arrays, of_end));

// Between two writes the folders are made anew; in the middle of one the file's place is gone.
TEST(Storage, ACacheRemovedDuringARunCostsTheWorkAndNothingElse) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string results = toy.results();
  for (const auto& [moment, status] :
       {std::pair("1 after", 0), {"5 after", 0}, {"9 after", 0}, {"4 before", 3}, {"9 before", 3}}) {
    toy.forget_everything();
    fs::remove_all(toy / "away");
    Process process(with_signal_at_rename(toy.command("run", {"--threads", "1"}), moment, SIGSTOP));
    ASSERT_TRUE(wait_until(process, [&] { return process.stopped(); }));
    fs::rename(toy.cache(), toy / "away");
    process.send(SIGCONT);
    const Outcome ended = process.wait();
    EXPECT_EQ(ended.status, status) << moment << ended.err;
    EXPECT_THAT(lines_with(ended.err, "error: "), SizeIs(status == 0 ? 0 : 1)) << moment << ended.err;
    if (status != 0) {
      ASSERT_EQ(toy.salbench("run").status, 0);
    }
    EXPECT_EQ(toy.results(), results) << moment;
    EXPECT_EQ(run_process({SALBENCH_PROGRAM, "verify", "--cache", toy.cache().string()}).status, 0);
  }
}

TEST(Storage, TheTimesOfFilesNeverMatter) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string results = toy.results();
  const auto now = fs::file_time_type::clock::now();
  const std::chrono::hours fifty_years(50 * 365 * 24);
  for (const auto& [cache_time, data_time] :
       {std::pair(now - fifty_years, now), std::pair(now, now - fifty_years),
        std::pair(now + fifty_years, now - fifty_years), std::pair(now - fifty_years, now + fifty_years)}) {
    for (const fs::path& file : toy.files()) fs::last_write_time(file, cache_time);
    for (const auto& entry : fs::recursive_directory_iterator(toy.data()))
      if (entry.is_regular_file()) fs::last_write_time(entry.path(), data_time);
    ASSERT_EQ(toy.salbench("run").status, 0);
    EXPECT_EQ(toy.computed(), 0);
    EXPECT_EQ(toy.results(), results);
  }
}

}  // namespace
}  // namespace salbench
