// SPDX-License-Identifier: GPL-3.0-or-later
#include <csignal>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "io/commands/process.h"
#include "io/commands/scratch_folder.h"
#include "io/file.h"
#include "stages/core/errors.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

constexpr std::chrono::seconds kLong(600);

// Runs `body` for every line that it reads, as $line.
std::string for_each_line(const std::string& body) { return "while read -r line; do " + body + "; done"; }

// The message of what an ask throws; empty if it is answered.
std::string failure_of(ServingCommand& command, std::chrono::duration<double> timeout = kLong) {
  try {
    return command.ask("x", "x", timeout) ? "" : "ended";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(ServingCommand, AnswersLineByLineInItsFolder) {
  const ScratchFolder folder;
  ServingCommand command(for_each_line("echo \"$line\" >> asked; echo \"done $line\""), folder.path());
  for (const std::string line : {"one", "two", "three"})
    EXPECT_TRUE(command.ask(line, "done " + line, kLong));
  EXPECT_EQ(read_file(folder.path() / "asked"), "one\ntwo\nthree\n");
  EXPECT_FALSE(command.has_ended());
}

TEST(ServingCommand, FindsItsAnswerInWhateverElseIsPrinted) {
  const ScratchFolder folder;
  ServingCommand command(
      for_each_line(
          "head -c 3000000 /dev/zero; printf '\\rloading x\\nx y\\nxx\\n x\\r'; echo x >&2; sleep 0.2; "
          "touch late; printf x; sleep 0.1; echo"),
      folder.path());
  EXPECT_EQ(failure_of(command), "");
  EXPECT_EQ(read_file(folder.path() / "late"), "") << "neither part of a line nor an error is an answer";
  EXPECT_THAT(command.last_lines(), HasSubstr("loading x | x y | xx"));
  EXPECT_LT(command.last_lines().size(), 5000U);
}

// Two pipes have no order between them; a flood in the one must not push out what was said in the other.
TEST(ServingCommand, KeepsTheLastLinesOfItsOutputAndOfItsErrors) {
  const ScratchFolder folder;
  const std::string flood = "yes 0123456789 | head -c 3300000";
  for (const std::string& body :
       {flood + "; echo; echo at last >&2", "echo at last >&2; " + flood + "; echo"}) {
    ServingCommand command(for_each_line(body + "; exit 3"), folder.path());
    EXPECT_THAT(failure_of(command), EndsWith("0123456789 | at last"));
  }
}

TEST(ServingCommand, WhatItSaidBeforeItsAnswerIsThereWithIt) {
  const ScratchFolder folder;
  ServingCommand command(for_each_line("echo no memory >&2; echo x"), folder.path());
  for (int i = 0; i < 200; ++i) {
    EXPECT_EQ(failure_of(command), "");
    EXPECT_EQ(command.last_lines(), "its last lines: no memory") << "without the answer";
  }
}

TEST(ServingCommand, SaysHowItEnded) {
  const ScratchFolder folder;
  const auto failure = [&](const std::string& body) {
    ServingCommand command(for_each_line(body), folder.path());
    return failure_of(command);
  };
  EXPECT_EQ(failure("exit 0"), "ended");
  EXPECT_EQ(failure("echo out of memory >&2; exit 3"),
            "the command ended with status 3; its last lines: out of memory");
  EXPECT_EQ(failure("kill -9 $$"), "the command was killed by signal 9; it printed nothing");
  for (const auto& [ending, from_outside] :
       std::vector<std::pair<const char*, bool>>{{"kill -9 $$", true},
                                                 {"kill -15 $$", true},
                                                 {"sh -c 'kill -9 $$'; exit $?", true},
                                                 {"kill -11 $$", false},
                                                 {"kill -6 $$", false},
                                                 {"exit 3", false}}) {
    ServingCommand command(for_each_line(ending), folder.path());
    const auto ask = [&] { command.ask("x", "x", std::chrono::minutes(1)); };
    if (from_outside)
      EXPECT_THROW(ask(), EndedFromOutside) << ending;
    else
      EXPECT_THAT(ask, testing::Throws<InputError>(
                           testing::Not(testing::WhenDynamicCastTo<const EndedFromOutside&>(testing::_))))
          << ending;
  }
  ServingCommand missing("no-such-program", folder.path());
  EXPECT_THAT(failure_of(missing), StartsWith("the command ended with status 127"));
  EXPECT_TRUE(missing.has_ended());
  EXPECT_THAT(failure_of(missing), StartsWith("the command ended with status 127"))
      << "asked again, no SIGPIPE";
}

TEST(ServingCommand, ThatEndsAfterAnAnswerFailsNoLineThatItHasNotRead) {
  const ScratchFolder folder;
  for (const std::string ending : {"exit 3", "kill -9 $$"}) {
    ServingCommand early("read -r line; echo x; " + ending, folder.path());
    EXPECT_EQ(failure_of(early), "");
    EXPECT_TRUE(early.has_answered());
    EXPECT_EQ(failure_of(early), "ended");
    EXPECT_NE(early.failure(), "");
    ServingCommand at_fault("read -r line; echo x; read -r line; " + ending, folder.path());
    EXPECT_EQ(failure_of(at_fault), "");
    EXPECT_THAT(failure_of(at_fault), StartsWith("the command ")) << "it has read the line";
    ServingCommand unready(ending, folder.path());
    EXPECT_THAT(failure_of(unready), StartsWith("the command ")) << "it has never answered";
    EXPECT_FALSE(unready.has_answered());
  }
}

TEST(ServingCommand, IsEndedAtTheTimeoutEvenIfItResists) {
  const ScratchFolder folder;
  std::string failure;
  for (double timeout = 0.5; !failure.ends_with(": ready") && timeout < 1000; timeout *= 4) {
    ServingCommand command("trap '' TERM; echo ready; while :; do sleep 0.1; done", folder.path());
    failure = failure_of(command, std::chrono::duration<double>(timeout));
  }
  EXPECT_THAT(failure, StartsWith("the command took longer than its timeout of "));
  EXPECT_THAT(failure, EndsWith(" s, and was ended; its last lines: ready"));
}

TEST(ServingCommand, ComesToTheEndOfItsLinesWhenNoMoreWillCome) {
  const TemporaryFolder kept;
  const ScratchFolder folder;
  {
    ServingCommand command(for_each_line("echo \"$line\"") + "; touch '" + (kept / "end").string() + "'",
                           folder.path());
  }
  EXPECT_EQ(read_file(kept / "end"), "");
  // One that does not end by itself is ended.
  { ServingCommand command("trap '' TERM; while :; do sleep 0.1; done", folder.path()); }
}

TEST(ServingCommand, OutlivesTheThreadThatStartedIt) {
  const ScratchFolder folder;
  std::unique_ptr<ServingCommand> command;
  std::thread([&] {
    command = std::make_unique<ServingCommand>(for_each_line("echo \"$line\""), folder.path());
    EXPECT_EQ(failure_of(*command), "");
  }).join();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_FALSE(command->has_ended());
  EXPECT_EQ(failure_of(*command), "");
}

TEST(ServingCommand, IsInterruptedByTheProgramsEnd) {
  EXPECT_EXIT(
      {
        ServingCommand idle(for_each_line("echo x"), "/");
        ServingCommand command("sleep 500", "/");
        std::signal(SIGALRM, [](int) { end_commands(); });
        ::alarm(1);
        try {
          failure_of(command);
        } catch (const Interrupted&) {
          while (!idle.has_ended()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
          ::_exit(7);
        }
        ::_exit(2);
      },
      testing::ExitedWithCode(7), "");
}

}  // namespace
}  // namespace salbench
