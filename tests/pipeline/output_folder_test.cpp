// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/output_folder.h"

#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/file.h"
#include "pipeline/commands/conclude.h"
#include "pipeline/config/section.h"
#include "stages/core/errors.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

const std::atomic<bool> kNotStopped = false, kStopped = true;

TEST(OutputFolder, IsOfOneRunAtATime) {
  const TemporaryFolder folder;
  int held[2];
  ASSERT_EQ(::pipe(held), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const OutputFolder mine(folder.path(), kNotStopped);
    const char byte = mine.is_held() ? 'y' : 'n';
    if (::write(held[1], &byte, 1) != 1) ::_exit(1);
    for (;;) ::pause();
  }
  char byte = 0;
  ASSERT_EQ(::read(held[0], &byte, 1), 1);
  EXPECT_EQ(byte, 'y');
  EXPECT_FALSE(OutputFolder(folder.path(), kStopped).is_held());
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_TRUE(OutputFolder(folder.path(), kNotStopped).is_held());
  for (const int end : held) ::close(end);
}

// Which waits for the other one's end, while that one may wait for its own: a function that starts a run.
TEST(OutputFolder, OfAnotherRunOfThisProcessIsAnError) {
  const TemporaryFolder folder;
  {
    const OutputFolder mine(folder.path(), kNotStopped);
    EXPECT_THAT([&] { OutputFolder(folder / ".", kNotStopped); },
                ThrowsMessage<ConfigError>(HasSubstr("another run of this process writes to this folder")));
  }
  EXPECT_TRUE(OutputFolder(folder.path(), kNotStopped).is_held());
}

TEST(OutputFolder, TablesAndRecordsOfNoRunAreNotReplaced) {
  for (const std::string& name : files_of_scores()) {
    const TemporaryFolder folder;
    folder.write(name, "years of work");
    EXPECT_THAT(
        [&] { OutputFolder(folder.path(), kNotStopped); },
        ThrowsMessage<ConfigError>(HasSubstr("has " + name + ", and no run.yaml, so it is of no run")));
  }
  for (const char* configuration :
       {"", "models: {RS: }\n", "# of mine\nprogram: mine\n", "# program: salbench"}) {
    const TemporaryFolder folder;
    folder.write("run.yaml", configuration);
    EXPECT_THAT([&] { OutputFolder(folder.path(), kNotStopped); },
                ThrowsMessage<ConfigError>(HasSubstr("run.yaml: is no record of a run")));
  }
}

TEST(OutputFolder, ThatOfAnEarlierRunIsTaken) {
  const std::string under_way(kUnderWay);
  for (const std::string& record : {under_way, under_way + "program: salbench 1.1.0\n",
                                    std::string("# SIMULATED\n# of gaze\nprogram: salbench 1.0.0\n")}) {
    const TemporaryFolder folder;
    folder.write("run.yaml", record);
    folder.write("results.csv", "item\n");
    folder.write("notes.txt", "of mine");
    OutputFolder(folder.path(), kNotStopped).begin("program: salbench 2\n");
    EXPECT_EQ(read_file(folder / "run.yaml"), "program: salbench 2\n");
    EXPECT_EQ(read_file(folder / "notes.txt"), "of mine");
  }
}

}  // namespace
}  // namespace salbench
