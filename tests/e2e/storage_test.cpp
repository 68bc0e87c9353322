// SPDX-License-Identifier: GPL-3.0-or-later
// Disks that are full, caches that may only be read, and files in the cache that rotted.
#include <chrono>
#include <utility>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <unistd.h>

#include "cache/layout.h"
#include "io/file.h"
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

// In memory, mounted for the test.
class SmallDisk {
 public:
  SmallDisk(fs::path folder, const char* size) : folder_(std::move(folder)) {
    fs::create_directories(folder_);
    mounted_ = ::mount("tmpfs", folder_.c_str(), "tmpfs", 0, size) == 0;
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  ~SmallDisk() {
    if (mounted_) ::umount2(folder_.c_str(), MNT_DETACH);
  }
  bool mounted() const { return mounted_; }
  bool resize(const char* size) const {
    return ::mount("tmpfs", folder_.c_str(), "tmpfs", MS_REMOUNT, size) == 0;
  }

 private:
  fs::path folder_;
  bool mounted_ = false;
};

Outcome verify(const Workspace& toy) {
  return run_process({SALBENCH_PROGRAM, "verify", "--cache", toy.cache().string()});
}

TEST(Storage, AFullDiskEndsTheRunAndWithMoreRoomItGoesOn) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string results = toy.results();
  fs::remove_all(toy.cache());
  const SmallDisk disk(toy.cache(), "size=300k"), exports(toy / "exports", "size=100k");
  if (!disk.mounted()) GTEST_SKIP() << "mounting is not allowed here";
  const auto expect_full = [](const Outcome& ended, const fs::path& folder) {
    EXPECT_EQ(ended.status, 3) << ended.err;
    EXPECT_THAT(lines_with(ended.err, "error: "),
                AllOf(SizeIs(1), Each(AllOf(HasSubstr(folder.string()), HasSubstr("No space left")))))
        << ended.err;
  };
  expect_full(toy.salbench("run"), toy.cache());
  const std::size_t kept = toy.artefacts().size();
  EXPECT_GT(kept, 5U);
  EXPECT_THAT(toy.left_over(), IsEmpty());

  ASSERT_TRUE(disk.resize("size=30m"));
  const Outcome more = toy.salbench("run");
  ASSERT_EQ(more.status, 0) << more.err;
  EXPECT_EQ(toy.computed() + kept, toy.artefacts().size());
  EXPECT_EQ(toy.results(), results);
  expect_full(toy.salbench("export", {"--to", (toy / "exports/toy.h5").string()}), toy / "exports");
  EXPECT_THAT(list_folder(toy / "exports"), IsEmpty());
}

// --- a cache that others may only read -------------------------------------------------------------------

// A complete cache, pictures included, whose permissions the program has not.
class ReadOnlyCache : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(toy_.salbench("export", {"--to", (toy_ / "all.h5").string(), "--pictures"}).status, 0);
    ASSERT_EQ(toy_.salbench("run").status, 0);
    change_permissions(fs::perm_options::remove);
  }
  void TearDown() override { change_permissions(fs::perm_options::add); }

  void change_permissions(fs::perm_options change) const {
    std::vector<fs::path> paths = {toy_.cache()};
    for (const auto& entry : fs::recursive_directory_iterator(toy_.cache())) paths.push_back(entry.path());
    for (const fs::path& path : paths) fs::permissions(path, fs::perms::owner_write, change);
  }

  // Permissions do not bind root, unless that capability is dropped.
  Outcome salbench(const std::vector<std::string>& call) const {
    std::vector<std::string> words = toy_.command(call[0], {call.begin() + 1, call.end()});
    if (::geteuid() == 0)
      words.insert(words.begin(),
                   {"/usr/bin/setpriv", "--bounding-set=-dac_override", "--inh-caps=-dac_override"});
    return run_process(words);
  }

  Workspace toy_{kMeshesOnly};
};

TEST_F(ReadOnlyCache, ThatIsCompleteIsAllThatIsNeeded) {
  const auto contents = toy_.artefacts();
  const std::string results = toy_.results();
  for (const std::vector<std::string>& call :
       {std::vector<std::string>{"run"},
        {"export", "--format", "maps", "--to", (toy_ / "maps").string()},
        {"export", "--to", (toy_ / "all.h5").string(), "--pictures"},
        {"plan"}}) {
    const Outcome outcome = salbench(call);
    EXPECT_EQ(outcome.status, 0) << call[0] << ": " << outcome.err;
    EXPECT_THAT(outcome.err, Not(HasSubstr(toy_.cache().string()))) << call[0];
  }
  EXPECT_EQ(verify(toy_).status, 0);
  EXPECT_EQ(toy_.computed(), 0U);
  EXPECT_EQ(toy_.results(), results);
  EXPECT_EQ(toy_.artefacts(), contents);
}

TEST_F(ReadOnlyCache, ThatSomethingIsToBeAddedToIsNamedBeforeTheWorkBegins) {
  const std::string results = toy_.results();
  const auto expect_refused = [&](const std::vector<std::string>& call) {
    const Outcome outcome = salbench(call);
    EXPECT_EQ(outcome.status, 3) << call[0];
    EXPECT_THAT(
        lines_with(outcome.err, "error: "),
        AllOf(SizeIs(1), Each(AllOf(HasSubstr(toy_.cache().string()), HasSubstr("cannot be written to")))))
        << outcome.err;
  };
  toy_.configure("dataset: {scans: false}\nmodels: {PS: , RS: , CS: }\n");
  expect_refused({"run"});
  expect_refused({"run", "--shard", "1/2"});
  expect_refused({"export", "--to", (toy_ / "all.h5").string()});
  EXPECT_EQ(toy_.results(), results);
  EXPECT_THAT(toy_.salbench("plan").out, HasSubstr("last run: finished")) << "the results of the run before";

  const fs::path damaged = file_with(toy_.cache(), "map.PS", "1");
  fs::permissions(damaged, fs::perms::owner_write, fs::perm_options::add);
  fs::resize_file(damaged, 100);
  const Outcome plan = salbench({"plan"});
  EXPECT_EQ(plan.status, 0) << plan.err;
  EXPECT_THAT(lines_with(plan.err, damaged.string()), SizeIs(1)) << plan.err;
  expect_refused({"run"});
}

// SegmentTest flips a byte at every place of a file.
class FlippedBytes : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(toy_.salbench("run").status, 0);
    results_ = toy_.results();
    contents_ = toy_.artefacts();
    damaged_ = toy_.files();
    for (const fs::path& file : damaged_) flip_byte(file, fs::file_size(file) / 2);
  }
  // All was computed again, and comes out as before.
  void expect_restored() const {
    EXPECT_EQ(verify(toy_).status, 0) << verify(toy_).out;
    EXPECT_EQ(toy_.computed(), contents_.size());
    EXPECT_EQ(toy_.results(), results_);
    EXPECT_EQ(toy_.artefacts(), contents_);
    const Outcome after = toy_.salbench("run");
    EXPECT_EQ(after.status, 0);
    EXPECT_THAT(after.err, Not(HasSubstr(toy_.cache().string()))) << "warned again";
    EXPECT_EQ(toy_.computed(), 0U);
  }

  const Workspace toy_{kMeshesOnly};
  std::string results_;
  std::vector<std::string> contents_;
  std::vector<fs::path> damaged_;
};

TEST_F(FlippedBytes, InEverySegmentAreFoundByARunWhichComputesThemAgain) {
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

TEST_F(FlippedBytes, InEverySegmentAreRemovedByGc) {
  EXPECT_EQ(verify(toy_).status, 1);
  EXPECT_EQ(toy_.files(), damaged_);
  const Outcome gc = toy_.salbench("gc");
  ASSERT_EQ(gc.status, 0) << gc.err;
  EXPECT_THAT(gc.out, HasSubstr(fmt::format(" {} damaged files", damaged_.size())));
  EXPECT_THAT(toy_.files(), SizeIs(0));
  ASSERT_EQ(toy_.salbench("run").status, 0);
  expect_restored();
}

TEST(Storage, TheTimesOfFilesNeverMatter) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string results = toy.results();
  const auto now = fs::file_time_type::clock::now();
  const std::chrono::hours fifty_years(50 * 365 * 24);
  for (const auto& [cache_time, data_time] :
       {std::pair(now + fifty_years, now - fifty_years), std::pair(now - fifty_years, now + fifty_years)}) {
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
