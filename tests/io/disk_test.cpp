// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/disk.h"

#include <gtest/gtest.h>

#include "io/file.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

constexpr const char* kMounts =
    "21 1 254:0 / / rw,relatime shared:1 - ext4 /dev/vda rw,errors=remount-ro\n"
    "30 21 0:44 / /home rw,relatime shared:2 master:3 - nfs4 server:/home rw,vers=4.2,local_lock=none\n"
    "31 30 0:45 / /home/with\\040blank rw - tmpfs tmpfs rw,size=8192k\n"
    "32 21 0:46 / /data rw - nfs server:/data rw,local_lock=all\n"
    "33 21 8:1 / /data rw - xfs /dev/sdb1 rw\n"
    "truncated line\n";

TEST(Mount, IsTheDeepestAboveThePath) {
  EXPECT_EQ(mount_of(kMounts, "/home/me/cache").type, "nfs4");
  EXPECT_EQ(mount_of(kMounts, "/home").point, "/home");
  EXPECT_EQ(mount_of(kMounts, "/homes/me").type, "ext4") << "a name that begins like a mount's";
  EXPECT_EQ(mount_of(kMounts, "/home/with blank/x").point, "/home/with blank");
  EXPECT_EQ(mount_of("", "/home").type, "");
}

TEST(Mount, ThatWasMountedOverAnotherHidesIt) { EXPECT_EQ(mount_of(kMounts, "/data/x").type, "xfs"); }

TEST(Mount, TellsWhoseLocksItHas) {
  EXPECT_TRUE(is_network(mount_of(kMounts, "/home")));
  EXPECT_FALSE(is_network(mount_of(kMounts, "/")));
  EXPECT_FALSE(locks_stay_here(mount_of(kMounts, "/home")));
  EXPECT_TRUE(locks_stay_here({"/data", "nfs", "rw,local_lock=all"}));
  EXPECT_TRUE(locks_stay_here({"/data", "nfs", "rw,nolock"}));
  EXPECT_FALSE(locks_stay_here({"/data", "nfs", "rw,nolocks"}));
}

TEST(ExistingFolder, IsTheNearestAbove) {
  const TemporaryFolder folder;
  const auto here = std::filesystem::canonical(folder.path());
  EXPECT_EQ(existing_folder(folder / "a/b/c"), here);
  EXPECT_EQ(existing_folder(folder.path()), here);
  folder.write("file", "");
  EXPECT_EQ(existing_folder(folder / "file/below"), here) << "a file is no folder";
  EXPECT_EQ(existing_folder("no such folder"), std::filesystem::current_path());
}

TEST(DiskFacts, AreThoseOfTheNearestFolder) {
  const TemporaryFolder folder;
  const DiskFacts facts = disk_facts(folder / "cache");
  EXPECT_EQ(facts.folder, std::filesystem::canonical(folder.path()));
  EXPECT_TRUE(facts.writable);
  EXPECT_NE(facts.mount.type, "");
  EXPECT_GT(facts.free.bytes, 0U);
  EXPECT_FALSE(std::filesystem::exists(folder / "cache"));
}

TEST(DiskFacts, OfAFolderOfTheSystemSayThatNothingCanBeWritten) {
  const DiskFacts facts = disk_facts("/proc/self/cache");
  EXPECT_EQ(facts.mount.type, "proc");
  EXPECT_FALSE(facts.writable);
  EXPECT_EQ(facts.free.bytes, FreeSpace::kNoLimit) << "it has no blocks that could be free";
  const DiskTrial trial = try_disk_without_names("/proc/self");
  EXPECT_FALSE(trial.sync_seconds || trial.locks);
  EXPECT_FALSE(try_disk("/proc/self").sync_seconds);
}

TEST(DiskTrial, MeasuresAndLeavesNothingBehind) {
  const TemporaryFolder folder;
  const DiskTrial trial = try_disk(folder.path());
  ASSERT_TRUE(trial.sync_seconds && trial.rename_seconds && trial.locks);
  EXPECT_GT(*trial.sync_seconds, 0);
  EXPECT_GT(*trial.rename_seconds, 0);
  EXPECT_TRUE(*trial.locks);
  EXPECT_TRUE(list_folder(folder.path()).empty());
}

// Nothing would be left by a crash either: the folder's own time of change stays, as it has no entry at any
// moment.
TEST(DiskTrial, WithoutNamesNeverTouchesTheFolder) {
  const TemporaryFolder folder;
  const auto before = std::filesystem::last_write_time(folder.path());
  const DiskTrial trial = try_disk_without_names(folder.path());
  if (!trial.sync_seconds) GTEST_SKIP() << "this file system has no files without names";
  EXPECT_FALSE(trial.rename_seconds);
  EXPECT_TRUE(trial.locks.value());
  EXPECT_EQ(std::filesystem::last_write_time(folder.path()), before);
}

}  // namespace
}  // namespace salbench
