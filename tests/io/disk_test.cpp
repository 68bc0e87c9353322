// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/disk.h"

#include <gtest/gtest.h>

#include "io/file.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

TEST(ExistingFolder, IsTheNearestAbove) {
  const TemporaryFolder folder;
  const auto here = std::filesystem::canonical(folder.path());
  EXPECT_EQ(existing_folder(folder / "a/b/c"), here);
  EXPECT_EQ(existing_folder(folder.path()), here);
  folder.write("file", "");
  EXPECT_EQ(existing_folder(folder / "file/below"), here) << "a file is no folder";
  EXPECT_EQ(existing_folder("no such folder"), std::filesystem::current_path());
}

TEST(FreeSpace, IsKnownOfADiskAndNotOfAFolderOfTheSystem) {
  const TemporaryFolder folder;
  EXPECT_GT(free_space(folder.path()).bytes, 0U);
  EXPECT_EQ(free_space("/proc/self").bytes, FreeSpace::kNoLimit) << "it has no blocks that could be free";
}

TEST(LocksHold, IsTriedAndLeavesNothingBehind) {
  const TemporaryFolder folder;
  EXPECT_TRUE(locks_hold(folder.path()).value());
  EXPECT_TRUE(list_folder(folder.path()).empty());
  EXPECT_FALSE(locks_hold("/proc/self").has_value()) << "nothing can be written there";
  EXPECT_FALSE(locks_hold(folder / "none").has_value());
}

}  // namespace
}  // namespace salbench
