// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/collect.h"

#include <csignal>

#include <sys/resource.h>

#include "cache/folder_store.h"
#include "cache/layout.h"
#include "io/file.h"
#include "tests/support/cache_files.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

NoProgress progress;

class CollectTest : public testing::Test {
 protected:
  static Recipe recipe(const std::string& stage, int k) {
    return {stage, 1, "k: " + std::to_string(k) + "\n", "", {}};
  }
  static Digest key(const std::string& stage, int k) { return key_of(recipe(stage, k)); }
  // Returns the bytes of its array.
  std::uint64_t save(const std::string& stage, const std::string& item, int k) {
    const Arrays arrays = {{"saliency", {1}, std::vector<double>{1.0 * k}, "1", "one value"}};
    store_.save(
        "52", artefact_of(recipe(stage, k), "field", arrays, {item, seconds_ += 0.125, "remark on " + item}));
    return sizeof(double);
  }
  std::vector<fs::path> files() const { return list_segments(folder_.path()); }
  Collected collect(const KeepSet& scope, bool dry_run = false) {
    store_.flush("52");
    return collect_garbage(folder_.path(), scope, dry_run, progress);
  }

  TemporaryFolder folder_;
  double seconds_ = 0;  // makes every file different
  FolderStore store_{folder_.path(), Access::read_write};
};

TEST_F(CollectTest, RemovesWhatIsNotNeededAndCountsItByStage) {
  save("fpfh", "1", 1);
  save("fpfh", "1", 2);
  save("map.XX", "1", 3);
  KeepSet scope;
  scope.add(key("fpfh", 1));
  const Collected result = collect(scope);
  EXPECT_THAT(artefact_names(folder_.path()), ElementsAre("fpfh@1"));
  FolderStore after(folder_.path(), Access::read_only);
  EXPECT_TRUE(after.load(key("fpfh", 1)));
  EXPECT_EQ(after.remark(key("fpfh", 1)), "remark on 1");
  ASSERT_EQ(result.stages.size(), 2U);
  EXPECT_EQ(result.stages[0].stage, "fpfh");
  EXPECT_EQ(result.stages[0].kept.files, 1U);
  EXPECT_EQ(result.stages[0].kept.bytes, sizeof(double));
  EXPECT_EQ(result.stages[0].removed.files, 1U);
  EXPECT_EQ(result.stages[1].removed.bytes, sizeof(double));
}

TEST_F(CollectTest, ASegmentThatIsNeededWholeIsNotTouched) {
  save("fpfh", "1", 1);
  KeepSet scope;
  scope.add(key("fpfh", 1));
  store_.flush("52");
  const auto before = fs::last_write_time(files().at(0));
  collect(scope);
  EXPECT_EQ(fs::last_write_time(files().at(0)), before);
}

TEST_F(CollectTest, ManySegmentsOfAFamilyBecomeOne) {
  KeepSet scope;
  for (int k = 0; k < 9; ++k) {
    save("fpfh", "1", k);
    store_.flush("52");
    scope.add(key("fpfh", k));
  }
  ASSERT_THAT(files(), SizeIs(9));
  CountedProgress count;
  collect_garbage(folder_.path(), scope, false, count);
  EXPECT_EQ(count.expected, 9U);
  EXPECT_EQ(count.done, 9U);
  EXPECT_THAT(files(), SizeIs(1));
  for (int k = 0; k < 9; ++k)
    EXPECT_TRUE(FolderStore(folder_.path(), Access::read_only).load(key("fpfh", k)));
}

// As in caches of several machines, copied into one folder: a model may give a different map on each.
TEST_F(CollectTest, OfSeveralWithOneKeyTheOneStaysThatRunsTake) {
  const Recipe common = recipe("map.XX", 1);
  for (int k = 0; k < 6; ++k) {
    const TemporaryFolder machine;
    FolderStore store(machine.path(), Access::read_write);
    const Arrays arrays = {{"saliency", {1}, std::vector<double>{1.0 * k}, "1", "one value"}};
    store.save("52", artefact_of(common, "field", arrays, {"1", 0.125, ""}));
    store.flush("52");
    fs::copy(machine.path(), folder_.path(), fs::copy_options::recursive | fs::copy_options::skip_existing);
  }
  ASSERT_THAT(files(), SizeIs(6));
  const auto map = [&] {
    return FolderStore(folder_.path(), Access::read_only).load(key_of(common))->at(0).values;
  };
  const ArrayValues before = map();
  KeepSet scope;
  scope.add(key_of(common));
  collect(scope);
  EXPECT_THAT(files(), SizeIs(1));
  EXPECT_EQ(map(), before);
}

TEST_F(CollectTest, DamagedSegmentsGoWhetherTheyWereRenamedOrNot) {
  KeepSet scope;
  for (int k = 1; k < 4; ++k) {
    save("fpfh", std::to_string(k), k);
    store_.flush("52");
    scope.add(key("fpfh", k));
  }
  for (const char* item : {"1", "2"}) damage(folder_.path(), "fpfh", item);
  EXPECT_FALSE(store_.load(key("fpfh", 1)));
  EXPECT_THAT(files(), SizeIs(2));
  EXPECT_THAT(list_damaged(folder_.path()), SizeIs(1));
  EXPECT_EQ(collect(scope).damaged.files, 2U);
  EXPECT_THAT(list_damaged(folder_.path()), IsEmpty());
  EXPECT_THAT(artefact_names(folder_.path()), ElementsAre("fpfh@3"));
}

TEST_F(CollectTest, ADryRunSaysTheSameAndRemovesNothing) {
  save("fpfh", "1", 1);
  store_.flush("52");
  const fs::path file = files().at(0);
  const fs::path damaged = folder_.write("00/" + SegmentName{"7", 1}.text() + ".damaged", "rotten");
  const fs::path dead = folder_.write("tmp/00c0ffee00c0ffee.salbench-part", "x");
  const Collected dry = collect({}, true);
  EXPECT_TRUE(fs::exists(file) && fs::exists(damaged) && fs::exists(dead));
  const Collected real = collect({});
  EXPECT_FALSE(fs::exists(file) || fs::exists(damaged) || fs::exists(dead));
  for (const Collected& result : {dry, real}) {
    EXPECT_EQ(result.stages.at(0).removed.files, 1U);
    EXPECT_EQ(result.damaged.files, 1U);
    EXPECT_EQ(result.damaged.bytes, 6U);
    EXPECT_EQ(result.unfinished.files, 1U);
  }
}

TEST_F(CollectTest, WhereKeysAreUnknownEverythingOfTheStageAndItemStays) {
  save("fpfh", "bull horn", 1);
  save("fpfh", "bull horn", 2);
  save("fpfh", "2", 3);
  save("scan", "bull horn", 4);
  KeepSet scope;
  scope.add_every_key("fpfh", "bull horn");
  collect(scope);
  EXPECT_THAT(artefact_names(folder_.path()), ElementsAre("fpfh@bull_horn", "fpfh@bull_horn"));
}

TEST_F(CollectTest, WhatIsNoArtefactIsNeverTouched) {
  save("fpfh", "1", 1);
  store_.flush("52");
  const std::string name = files().at(0).filename().string();
  const UnfinishedFile being_written(folder_ / "tmp");
  const std::vector<fs::path> foreign = {folder_.write("notes.txt", "x"),
                                         folder_.write("00/readme", "x"),
                                         folder_.write("00/1.h5", "x"),
                                         folder_.write("00/deep/" + name, "x"),
                                         folder_.write("fpfh/00/1.h5", "x"),
                                         folder_.write("00/mine.h5.damaged", "x"),
                                         folder_.write("tmp/0123456789abcdef.mine", "x"),
                                         being_written.path()};
  collect({});
  for (const fs::path& file : foreign) EXPECT_TRUE(fs::exists(file)) << file;
  EXPECT_TRUE(fs::exists(folder_ / "CACHEDIR.TAG"));
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(CollectTest, AFolderThatIsNoCacheIsRefused) {
  const TemporaryFolder other;
  const fs::path copy = other.write("00/" + SegmentName{"52", 1}.text() + ".damaged", "x");
  EXPECT_THROW(collect_garbage(other.path(), {}, false, progress), StorageError);
  EXPECT_TRUE(fs::exists(copy));
}

// One of two families has artefacts to keep, so that it must be rewritten, for which there is no room.
TEST_F(CollectTest, AFullDiskHasRoomFirst) {
  KeepSet scope;
  scope.add(key("fpfh", 1));
  save("fpfh", "1", 1), save("fpfh", "2", 2);
  store_.flush("52");
  store_.save("53", artefact_of(recipe("fpfh", 3), "field", {}, {"53"}));
  store_.flush("53");
  ASSERT_THAT(files(), SizeIs(2));
  rlimit unlimited{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &unlimited), 0);
  const rlimit tiny{100, unlimited.rlim_max};
  std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &tiny), 0);
  EXPECT_THROW(collect_garbage(folder_.path(), scope, false, progress), StorageError);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &unlimited), 0);
  EXPECT_THAT(files(), SizeIs(1)) << "what can go without being written anew has gone";
  EXPECT_TRUE(FolderStore(folder_.path(), Access::read_only).load(key("fpfh", 1)));
}

TEST_F(CollectTest, AStoreThatIsOpenFindsWhatWasWrittenAnew) {
  KeepSet scope;
  scope.add(key("fpfh", 1));
  save("fpfh", "1", 1), save("fpfh", "2", 2);
  store_.flush("52");
  FolderStore open(folder_.path(), Access::read_only);
  collect(scope);
  for (FolderStore* store : {&open, &store_}) {
    EXPECT_TRUE(store->load(key("fpfh", 1)));
    EXPECT_FALSE(store->load(key("fpfh", 2)));
  }
}

TEST_F(CollectTest, AStoreThatIsOpenSeesAMissAndStoresItAgain) {
  save("fpfh", "1", 1);
  collect({});
  EXPECT_FALSE(store_.load(key("fpfh", 1)));
  save("fpfh", "1", 1);
  store_.flush("52");
  EXPECT_THAT(files(), SizeIs(1));
}

}  // namespace
}  // namespace salbench
