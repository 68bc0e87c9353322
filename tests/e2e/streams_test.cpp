// SPDX-License-Identifier: GPL-3.0-or-later
// Standard output and standard error that are closed, full, or pipes that nobody reads.
#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "tests/e2e/workspace.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// The command after the shell has changed its standard streams: "exec > /dev/full".
Outcome run_after(const std::string& change, std::vector<std::string> command) {
  // With PYTHONUNBUFFERED, Python has no buffered output left at exit, and cannot fail to write it.
  command.insert(command.begin(),
                 {"/bin/sh", "-c", change + " && unset PYTHONUNBUFFERED && exec \"$0\" \"$@\""});
  return run_process(command);
}

// Over the folders of the workspace, with the options that the subcommand knows; or a call without folders.
std::vector<std::string> command_of(const Workspace& toy, const std::string& call) {
  const std::string data = toy.data().string(), cache = toy.cache().string(), config = toy.config().string();
  if (call.find("--") != std::string::npos) {
    std::vector<std::string> words = {SALBENCH_PROGRAM};
    for (std::size_t from = 0; from < call.size();) {
      const std::size_t to = std::min(call.find(' ', from), call.size());
      words.push_back(call.substr(from, to - from));
      from = to + 1;
    }
    return words;
  }
  if (call == "inspect") return {SALBENCH_PROGRAM, call, "schelling", "--data", data};
  if (call == "import")
    return {SALBENCH_PROGRAM, call, "schelling", "--data", data, "--to", (toy / "one_form").string()};
  if (call == "config") return {SALBENCH_PROGRAM, call, config};
  if (call == "verify" || call == "gc")
    return {SALBENCH_PROGRAM, call, config, "--data", data, "--cache", cache};
  if (call == "export") return toy.command(call, {"--to", (toy / "all.h5").string()});
  return toy.command(call);
}

class StandardOutput : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override { ASSERT_EQ(toy_.salbench("run").status, 0); }
  Workspace toy_{kMeshesOnly};
};

TEST_P(StandardOutput, ThatCannotBeWrittenIsAnErrorThatIsNamedOnce) {
  for (const char* change : {"exec > /dev/full", "exec >&-"}) {
    SCOPED_TRACE(change);
    const Outcome outcome = run_after(change, command_of(toy_, GetParam()));
    EXPECT_EQ(outcome.status, 3) << outcome.err;
    EXPECT_THAT(lines_with(outcome.err, "error: "),
                ElementsAre(AllOf(testing::StartsWith("error: standard output: "),
                                  testing::AnyOf(HasSubstr("No space left"), HasSubstr("it is closed")))));
  }
}

// As of any program: `salbench plan | head -1` ends it without a word.
TEST_P(StandardOutput, ThatNobodyReadsEndsTheProgramSilently) {
  const std::string unread =
      "cd '" + toy_.data().string() +
      "' && mkfifo unread && exec 3<>unread && exec > unread && exec 3<&- && rm unread";
  const Outcome outcome = run_after(unread, command_of(toy_, GetParam()));
  EXPECT_EQ(outcome.status, 128 + SIGPIPE);
  EXPECT_THAT(lines_with(outcome.err, "error: "), IsEmpty());
}
INSTANTIATE_TEST_SUITE_P(Calls, StandardOutput,
                         testing::Values("run", "export", "plan", "config", "verify", "gc", "inspect",
                                         "import", "--help", "run --help", "inspect --help", "--version"),
                         [](const auto& test) {
                           std::string name;
                           for (const char c : std::string(test.param))
                             if (std::isalpha(static_cast<unsigned char>(c)) != 0) name += c;
                           return name;
                         });

TEST(StandardOutput, IsNotMissedByARunThatPrintsNothing) {
  const Workspace toy(kMeshesOnly);
  const Outcome run = run_after("exec >&-", toy.command("run", {"--quiet"}));
  EXPECT_EQ(run.status, 0) << run.err;
}

TEST(StandardOutput, IsTheLastThingThatARunNeeds) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(run_after("exec > /dev/full", toy.command("run")).status, 3);
  const std::string results = toy.results();
  EXPECT_THAT(toy.salbench("plan").out, HasSubstr("last run: finished"));
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.computed(), 0U);
  EXPECT_EQ(toy.results(), results);
}

// What is opened next would get the number of standard error, and be written into.
TEST(StandardError, ThatIsClosedOrFullChangesNothing) {
  const Workspace toy;
  toy.write("data set/Meshes/3.off", "OFF\nno mesh\n");  // makes an error and a list of failures
  ASSERT_EQ(toy.salbench("run").status, 1);
  const auto contents = toy.contents();
  const std::string results = toy.results();
  for (const char* change : {"exec 2>&-", "exec 2> /dev/full", "exec 0<&- 2>&-"}) {
    SCOPED_TRACE(change);
    toy.forget_everything();
    EXPECT_EQ(run_after(change, toy.command("run")).status, 1);
    EXPECT_EQ(fs::file_size(toy.cache() / "claims"), 0U);
    EXPECT_EQ(toy.contents(), contents);
    EXPECT_EQ(toy.results(), results);
    EXPECT_THAT(toy.left_over(), IsEmpty());
  }
}

}  // namespace
}  // namespace salbench
