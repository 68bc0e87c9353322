// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/commands/scratch_folder.h"

#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "stages/core/errors.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// A root of its own: nothing that others have left in the system's is touched.
class ScratchFolderTest : public testing::Test {
 protected:
  ScratchFolderTest() { use(root_.path()); }
  ~ScratchFolderTest() override {
    ::unsetenv("TMPDIR");
    if (!before_.empty()) use(before_);
  }

  static void use(const fs::path& root) { ::setenv("TMPDIR", root.c_str(), 1); }

  std::string before_ = std::getenv("TMPDIR") == nullptr ? "" : std::getenv("TMPDIR");
  TemporaryFolder root_;
};

TEST_F(ScratchFolderTest, IsRemovedWithAllThatIsInIt) {
  const fs::path outside = root_.write("outside/kept", "x");
  fs::path path;
  {
    const ScratchFolder folder;
    path = folder.path();
    fs::create_directories(path / "a/b");
    root_.write(path / "a/b/c", "x");
    fs::create_symlink(outside.parent_path(), path / "link");
    EXPECT_TRUE(fs::exists(path / "link/kept"));
  }
  EXPECT_FALSE(fs::exists(path));
  EXPECT_TRUE(fs::exists(outside));
}

TEST_F(ScratchFolderTest, OfARelativeRootHasAWholePath) {
  const fs::path before = fs::current_path();
  fs::create_directories(root_ / "tmp");
  fs::current_path(root_.path());
  use("tmp");
  const ScratchFolder folder;
  fs::current_path(before);
  EXPECT_TRUE(folder.path().is_absolute());
  EXPECT_TRUE(fs::is_directory(folder.path()));
}

TEST_F(ScratchFolderTest, IsLeftByACopyOfTheProcess) {
  const ScratchFolder folder;
  const pid_t process = ::fork();
  if (process == 0) {
    folder.~ScratchFolder();
    ::_exit(0);
  }
  ::waitpid(process, nullptr, 0);
  EXPECT_TRUE(fs::is_directory(folder.path()));
}

TEST_F(ScratchFolderTest, ThatCannotBeMadeIsNamed) {
  use(root_.write("file", ""));  // the system's own is used in its place
  { const ScratchFolder folder; }
  use("/proc");
  EXPECT_THAT([] { const ScratchFolder folder; },
              testing::ThrowsMessage<StorageError>(testing::AllOf(HasSubstr("/proc/"), HasSubstr("TMPDIR"))));
}

TEST_F(ScratchFolderTest, OfADeadProcessIsRemovedAndNothingElse) {
  const pid_t process = ::fork();
  if (process == 0) {
    const ScratchFolder dead;
    ::_exit(::system(("echo x > " + (dead.path() / "file").string()).c_str()));
  }
  ::waitpid(process, nullptr, 0);
  ASSERT_EQ(std::distance(fs::directory_iterator(root_.path()), {}), 1);
  const fs::path dead = fs::directory_iterator(root_.path())->path();
  ASSERT_TRUE(fs::exists(dead / "file"));

  const ScratchFolder alive;
  root_.write("salbench-scratch-notes/file", "x");
  root_.write("salbench-scratch-0123456789ABCDEF/file", "x");
  root_.write("other/file", "x");
  root_.write("salbench-scratch-0123456789abcdef", "a file");
  fs::create_directory_symlink(root_ / "other", root_ / "salbench-scratch-0123456789abcdee");
  remove_abandoned_scratch();
  EXPECT_FALSE(fs::exists(dead));
  EXPECT_TRUE(fs::exists(alive.path()));
  for (const char* kept :
       {"salbench-scratch-notes/file", "salbench-scratch-0123456789ABCDEF/file", "other/file",
        "salbench-scratch-0123456789abcdef", "salbench-scratch-0123456789abcdee/file"})
    EXPECT_TRUE(fs::exists(root_ / kept)) << kept;
}

TEST_F(ScratchFolderTest, ItsNameIsNoPartOfAMessage) {
  const ScratchFolder folder;
  const std::string path = folder.path().string();
  for (const auto& [message, without] : {std::pair{"File \"" + path + "/m.py\", line 1; " + path + "/a",
                                                   std::string("File \"m.py\", line 1; a")},
                                         {path, path},
                                         {path + "0/a", path + "0/a"},
                                         {path + "/", std::string()},
                                         {"a/salbench-scratch-1/b", std::string("a/salbench-scratch-1/b")}})
    EXPECT_EQ(without_scratch_folders(message), without);
}

}  // namespace
}  // namespace salbench
