// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/process.h"

#include <csignal>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "io/file.h"
#include "stages/core/errors.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

// The message of a failure; empty if the command succeeds.
std::string failure_of(const std::string& command, double timeout = 60) {
  const ScratchFolder folder;
  try {
    run_command(command, folder.path(), std::chrono::duration<double>(timeout));
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

// The process whose number a command has written there is gone, or is a zombie that nobody has reaped yet.
bool is_gone(const fs::path& file) {
  const std::string number = read_file(file);
  std::string stat;
  try {
    stat = read_file("/proc/" + number.substr(0, number.find('\n')) + "/status");
  } catch (const InputError&) {
    return true;
  }
  return stat.empty() || stat.find("State:\tZ") != std::string::npos;
}

TEST(RunCommand, RunsInItsFolderWithNothingToRead) {
  const ScratchFolder folder;
  run_command("cat > in; pwd > here", folder.path(), std::chrono::seconds(60));
  EXPECT_EQ(read_file(folder.path() / "in"), "");
  EXPECT_EQ(fs::path(read_file(folder.path() / "here")), folder.path().string() + "\n");
}

TEST(RunCommand, ATimeoutBeyondTheClockIsNone) { EXPECT_EQ(failure_of("exit 0", 1e300), ""); }

TEST(RunCommand, SaysHowItEndedAndWhatItPrintedLast) {
  EXPECT_EQ(failure_of("exit 0"), "");
  EXPECT_EQ(failure_of("exit 3"), "the command ended with status 3; it printed nothing");
  EXPECT_EQ(failure_of("echo one; echo two >&2; false"),
            "the command ended with status 1; its last lines: one | two");
  EXPECT_EQ(failure_of("kill -9 $$"), "the command was killed by signal 9; it printed nothing");
  EXPECT_THAT(failure_of("no-such-program"),
              AllOf(StartsWith("the command ended with status 127"), HasSubstr("not found")));
  EXPECT_THAT(failure_of("printf 'a\\033[31mb\\000c\\n'; false"), EndsWith("a?[31mb?c"));
}

TEST(RunCommand, KeepsTheLastLinesOfAFlood) {
  const std::string failure = failure_of("yes 0123456789 | head -c 33000000; echo last; false");
  EXPECT_THAT(failure, EndsWith("0123456789 | last"));
  EXPECT_LT(failure.size(), 5000U);
  EXPECT_LT(failure_of("head -c 30000000 /dev/zero; false").size(), 5000U) << "without a line end";
}

TEST(RunCommand, EndsTheGroupAtTheTimeoutEvenIfItResists) {
  const TemporaryFolder kept;
  const std::string child = (kept / "child").string();
  const std::string failure = failure_of(
      "trap '' TERM; sh -c 'trap \"\" TERM; echo $$ > " + child + "; sleep 50' & echo ready; wait", 0.3);
  EXPECT_EQ(failure,
            "the command took longer than its timeout of 0.3 s, and was ended; its last lines: ready");
  EXPECT_TRUE(is_gone(child));
}

TEST(RunCommand, LeavesNothingInTheBackgroundAndWaitsForNone) {
  const TemporaryFolder kept;
  const std::string child = (kept / "child").string();
  EXPECT_EQ(failure_of("sleep 50 & echo $! > " + child), "");
  EXPECT_TRUE(is_gone(child));
}

TEST(RunCommand, IsInterruptedByTheProgramsEnd) {
  EXPECT_EXIT(
      {
        std::signal(SIGALRM, [](int) { end_commands(SIGTERM); });
        ::alarm(1);
        try {
          run_command("sleep 50", "/", std::chrono::seconds(60));
        } catch (const CommandInterrupted&) {
          ::_exit(7);
        }
        ::_exit(1);
      },
      testing::ExitedWithCode(7), "");
}

TEST(ScratchFolder, IsRemovedWithAllThatIsInIt) {
  fs::path path;
  {
    const ScratchFolder folder;
    path = folder.path();
    run_command("mkdir -p a/b; echo x > a/b/c; ln -s / root", path, std::chrono::seconds(60));
    EXPECT_TRUE(fs::exists(path / "a/b/c"));
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST(ShellQuoted, TheShellReadsTheSameText) {
  for (const std::string text : {"plain/name.ply", "a blank", "it's", "$HOME `x` \"q\" \\", ""}) {
    const ScratchFolder folder;
    run_command("printf %s " + shell_quoted(text) + " > out", folder.path(), std::chrono::seconds(60));
    EXPECT_EQ(read_file(folder.path() / "out"), text);
  }
}

}  // namespace
}  // namespace salbench
