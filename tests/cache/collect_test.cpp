// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/collect.h"

#include <gtest/gtest.h>

#include "cache/folder_store.h"
#include "stages/core/errors.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

NoProgress progress;

class CollectTest : public testing::Test {
 protected:
  static Recipe recipe(const std::string& stage, int k) {
    return {stage, 1, "k: " + std::to_string(k) + "\n", "", {}};
  }
  fs::path save(const std::string& stage, const std::string& item, int k) {
    store_.save(recipe(stage, k), "field",
                {{"saliency", {1}, std::vector<double>{1.0 * k}, "1", "one value"}},
                {.item = item, .seconds = 0, .attributes = {}});
    return *store_.path(stage, key_of(recipe(stage, k)));
  }

  TemporaryFolder folder_;
  FolderStore store_{folder_.path(), Access::read_write};
};

TEST_F(CollectTest, RemovesWhatIsNotNeededAndCountsItByStage) {
  const fs::path needed = save("fpfh", "1", 1), old = save("fpfh", "1", 2), unused = save("map.XX", "1", 3);
  KeepSet scope;
  scope.add("fpfh", key_of(recipe("fpfh", 1)));
  scope.add("map.XX", key_of(recipe("fpfh", 1)));  // a key counts for its own stage alone
  const std::uint64_t old_size = fs::file_size(old), unused_size = fs::file_size(unused);
  const Collected result = collect_garbage(folder_.path(), scope, false, progress);
  EXPECT_TRUE(fs::exists(needed));
  EXPECT_FALSE(fs::exists(old));
  EXPECT_FALSE(fs::exists(unused));
  ASSERT_EQ(result.stages.size(), 2U);
  EXPECT_EQ(result.stages[0].stage, "fpfh");
  EXPECT_EQ(result.stages[0].kept.files, 1U);
  EXPECT_EQ(result.stages[0].kept.bytes, fs::file_size(needed));
  EXPECT_EQ(result.stages[0].removed.files, 1U);
  EXPECT_EQ(result.stages[0].removed.bytes, old_size);
  EXPECT_EQ(result.stages[1].removed.bytes, unused_size);
}

TEST_F(CollectTest, ADryRunSaysTheSameAndRemovesNothing) {
  const fs::path file = save("fpfh", "1", 1);
  const fs::path damaged = folder_.write("damaged/" + file.filename().string(), "rotten");
  const fs::path dead = folder_.write("tmp/00c0ffee00c0ffee.salbench-part", "x");
  const Collected dry = collect_garbage(folder_.path(), {}, true, progress);
  EXPECT_TRUE(fs::exists(file) && fs::exists(damaged) && fs::exists(dead));
  const Collected real = collect_garbage(folder_.path(), {}, false, progress);
  EXPECT_FALSE(fs::exists(file) || fs::exists(damaged) || fs::exists(dead));
  for (const Collected& result : {dry, real}) {
    EXPECT_EQ(result.stages.at(0).removed.files, 1U);
    EXPECT_EQ(result.damaged.files, 1U);
    EXPECT_EQ(result.damaged.bytes, 6U);
    EXPECT_EQ(result.unfinished.files, 1U);
  }
}

TEST_F(CollectTest, WhereKeysAreUnknownEverythingOfTheStageAndItemStays) {
  const fs::path a = save("fpfh", "bull horn", 1), b = save("fpfh", "bull horn", 2);
  const fs::path other_item = save("fpfh", "2", 3), other_stage = save("scan", "bull horn", 4);
  KeepSet scope;
  scope.add_every_key("fpfh", "bull horn");
  collect_garbage(folder_.path(), scope, false, progress);
  EXPECT_TRUE(fs::exists(a) && fs::exists(b));
  EXPECT_FALSE(fs::exists(other_item) || fs::exists(other_stage));
}

TEST_F(CollectTest, WhatIsNoArtefactIsNeverTouched) {
  const std::string artefact = save("fpfh", "1", 1).filename().string();
  const UnfinishedFile being_written(folder_ / "tmp");
  const std::vector<fs::path> foreign = {folder_.write("notes.txt", "x"),
                                         folder_.write("fpfh/readme", "x"),
                                         folder_.write("fpfh/00/1.h5", "x"),
                                         folder_.write("fpfh/00/deep/" + artefact, "x"),
                                         folder_.write("damaged/mine.h5", "x"),
                                         folder_.write("tmp/0123456789abcdef.mine", "x"),
                                         being_written.path()};
  collect_garbage(folder_.path(), {}, false, progress);
  for (const fs::path& file : foreign) EXPECT_TRUE(fs::exists(file)) << file;
  EXPECT_TRUE(fs::exists(folder_ / "CACHEDIR.TAG"));
}

TEST_F(CollectTest, AFolderThatIsNoCacheIsRefused) {
  const TemporaryFolder other;
  const fs::path file = save("fpfh", "1", 1);
  const fs::path copy = other.write("damaged/" + file.filename().string(), "x");
  EXPECT_THROW(collect_garbage(other.path(), {}, false, progress), StorageError);
  EXPECT_TRUE(fs::exists(copy));
}

TEST_F(CollectTest, AStoreThatIsOpenSeesAMissAndStoresItAgain) {
  const fs::path file = save("fpfh", "1", 1);
  collect_garbage(folder_.path(), {}, false, progress);
  EXPECT_FALSE(store_.load("fpfh", key_of(recipe("fpfh", 1))));
  EXPECT_EQ(save("fpfh", "1", 1), file);
  EXPECT_TRUE(fs::exists(file));
}

}  // namespace
}  // namespace salbench
