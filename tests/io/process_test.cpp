// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/commands/process.h"

#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/commands/scratch_folder.h"
#include "io/file.h"
#include "stages/core/errors.h"
#include "tests/support/processes.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

// The message of a failure; empty if the command succeeds.
std::string failure_of(const std::string& command, double timeout = 600) {
  const ScratchFolder folder;
  try {
    run_command(command, folder.path(), std::chrono::duration<double>(timeout));
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

// Waits for a file with something in it, until the command is ended. A shell's line.
std::string wait_for(const fs::path& file) {
  return "while [ ! -s '" + file.string() + "' ]; do sleep 0.01; done\n";
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

// Ways to get out of a command's hands, for a process that runs $child.
struct Stray {
  const char* name;
  const char* start;
};
void PrintTo(const Stray& stray, std::ostream* out) { *out << stray.name; }

constexpr std::array kStrays = {Stray{"InTheBackground", "sh -c \"$child\" &"},
                                Stray{"InAnotherGroup", "timeout 1000 sh -c \"$child\" &"},
                                Stray{"OfADeadParent", "(sh -c \"$child\" &)"},
                                Stray{"Stopped", "sh -c \"${child%exec*}kill -STOP \\$\\$\" &"}};

// A shell's lines that start one, which writes its number and resists. It sleeps for longer than any test,
// and no longer than a forgotten process may.
std::string started(const Stray& stray, const fs::path& number_file) {
  return "child='trap \"\" TERM HUP INT; echo $$ > " + number_file.string() + "; exec sleep 1000'\n" +
         stray.start + "\n";
}

bool has_number(const fs::path& file) { return fs::exists(file) && !read_file(file).empty(); }

bool is_gone_by(const fs::path& number_file) {
  const std::string number = read_file(number_file);
  return is_gone(number.substr(0, number.find('\n')));
}

class StrayProcess : public testing::TestWithParam<Stray> {
 protected:
  fs::path number_file() const { return kept_ / "number"; }
  TemporaryFolder kept_;
};

TEST_P(StrayProcess, EndsWithItsCommand) {
  EXPECT_EQ(failure_of(started(GetParam(), number_file()) + wait_for(number_file())), "");
  EXPECT_TRUE(is_gone_by(number_file()));
}

TEST_P(StrayProcess, EndsWithAProgramThatIsKilled) {
  const pid_t program = ::fork();
  if (program == 0) {
    failure_of(started(GetParam(), number_file()) + "sleep 1000");
    ::_exit(0);
  }
  EXPECT_TRUE(soon([&] { return has_number(number_file()); }));
  ::kill(program, SIGKILL);
  ::waitpid(program, nullptr, 0);
  EXPECT_TRUE(soon([&] { return is_gone_by(number_file()); }));
}
INSTANTIATE_TEST_SUITE_P(RunCommand, StrayProcess, testing::ValuesIn(kStrays),
                         testing::PrintToStringParamName());

// Also in the moment of its start, when the program cannot have told anybody of it.
TEST(RunCommand, EndsWithAProgramThatIsKilledAtAnyMoment) {
  const TemporaryFolder kept;
  const fs::path mark = kept / "mark";  // a program, so that its processes can be told from others
  fs::copy("/bin/sleep", mark);
  for (int moment = 0; moment < 100; ++moment) {
    const pid_t program = ::fork();
    if (program == 0) {
      prepare_commands();
      std::thread killer([&] {
        std::this_thread::sleep_for(std::chrono::microseconds(20 * moment));
        ::kill(::getpid(), SIGKILL);
      });
      failure_of("exec " + mark.string() + " 1000");
    }
    ::waitpid(program, nullptr, 0);
  }
  EXPECT_TRUE(soon([&] { return processes_with(mark.string()).empty(); }));
}

TEST(RunCommand, EndsEveryProcessAtTheTimeoutEvenIfItResists) {
  const TemporaryFolder kept;
  std::string command = "trap '' TERM\n";
  for (const Stray& stray : kStrays)
    command += started(stray, kept / stray.name) + wait_for(kept / stray.name);
  command += "echo ready; wait; sleep 1000";
  std::string failure;
  for (double timeout = 0.5; !failure.ends_with(": ready") && timeout < 1000; timeout *= 4) {
    for (const Stray& stray : kStrays) fs::remove(kept / stray.name);
    failure = failure_of(command, timeout);
  }
  EXPECT_THAT(failure, StartsWith("the command took longer than its timeout of "));
  EXPECT_THAT(failure, EndsWith(" s, and was ended; its last lines: ready"));
  for (const Stray& stray : kStrays) EXPECT_TRUE(is_gone_by(kept / stray.name)) << stray.name;
}

// Each process of a chain starts the next one and ends: there is always one, and never the same.
TEST(RunCommand, EndsProcessesThatReplaceThemselves) {
  const TemporaryFolder kept;
  const std::string link =
      kept.write("link.sh", "echo x >> \"$0.log\"\n[ $1 -gt 0 ] && sh \"$0\" $(($1-1)) &\n").string();
  EXPECT_EQ(failure_of("sh " + link + " 20000; " + wait_for(link + ".log")), "");
  EXPECT_TRUE(processes_with(link).empty());
}

TEST(RunCommand, GetsNothingOfTheProgramButItsEnvironment) {
  EXPECT_EXIT(
      {
        for (const int signal : {SIGHUP, SIGCHLD, SIGXFSZ}) std::signal(signal, SIG_IGN);
        const ScratchFolder folder;
        run_command("ls /proc/self/fd > files; grep SigIgn /proc/self/status > ignored", folder.path(),
                    std::chrono::seconds(60));
        // But for two signals that the C library keeps for itself.
        const bool none =
            read_file(folder.path() / "ignored").find("0000000180000000") != std::string::npos ||
            read_file(folder.path() / "ignored").find("0000000000000000") != std::string::npos;
        // The last one is what ls lists.
        ::_exit(none && read_file(folder.path() / "files") == "0\n1\n2\n3\n" ? 7 : 1);
      },
      testing::ExitedWithCode(7), "");
}

TEST(RunCommand, MayHaveALongCommandLine) {
  EXPECT_EQ(failure_of(": " + std::string(120'000, 'x')), "");
  EXPECT_EQ(failure_of(": " + std::string(1'000'000, 'x')), "the command is longer than the system allows");
}

TEST(RunCommand, IsInterruptedByTheProgramsEnd) {
  EXPECT_EXIT(
      {
        std::signal(SIGALRM, [](int) { end_commands(); });
        ::alarm(1);
        try {
          run_command("sleep 500", "/", std::chrono::seconds(600));
        } catch (const Interrupted&) {
          ::_exit(7);
        }
        ::_exit(1);
      },
      testing::ExitedWithCode(7), "");
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
