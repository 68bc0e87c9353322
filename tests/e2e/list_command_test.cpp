// SPDX-License-Identifier: GPL-3.0-or-later
// A command that is kept at work, and gets one shape after the other: how often it is started, and what
// becomes of one that misbehaves.
#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "tests/e2e/commands.h"
#include "tests/e2e/workspace.h"
#include "tests/support/processes.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;
using testing::SizeIs;

// A command that counts its starts, and is then this one.
std::string starts_counted(const fs::path& log, const std::string& command) {
  return fmt::format("echo run >> '{}'; exec {}", log.string(), command);
}

TEST(ListCommand, GivesTheSameMapsAsACommandPerShapeAndIsStartedOnce) {
  const Workspace toy;
  const std::string model = fmt::format("/usr/bin/python3 '{}'", SALBENCH_OWN_MODEL);
  toy.configure(
      fmt::format("scan: {{step_degrees: 1}}\nmodels: {{EACH: {{command: \"printf '%s\\\\t%s\\\\n' {{shape}} "
                  "{{out}} | {} "
                  "/dev/stdin\"}}, ONCE: {{command: \"{}\", gpu: 1}}}}\n",
                  model, starts_counted(toy / "log", model + " {list.h5}")));
  const Outcome run = toy.salbench("run", {"--threads", "4"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(lines_of(toy / "log"), 1U);

  ASSERT_EQ(toy.salbench("export", {"--format", "maps", "--to", (toy / "maps").string()}).status, 0);
  std::size_t maps = 0;
  for (const auto& entry : fs::directory_iterator(toy / "maps/EACH")) {
    EXPECT_EQ(read_file(entry.path()), read_file(toy / "maps/ONCE" / entry.path().filename()));
    ++maps;
  }
  EXPECT_EQ(maps, 2U * (1 + 12));
  EXPECT_EQ(lines_of(toy / "log"), 1U) << "the maps are in the cache";
}

TEST(ListCommand, IsStartedAtMostOncePerThreadAndAllEndWithTheRun) {
  const Workspace toy;
  const fs::path log = toy / "log", ends = toy / "ends";
  toy.configure(
      fmt::format("scan: {{step_degrees: 1}}\nmodels: {{MINE: {{command: \"echo run >> '{}'; "
                  "/usr/bin/python3 '{}' {{list.h5}}; "
                  "echo run >> '{}'\"}}}}\n",
                  log.string(), SALBENCH_OWN_MODEL, ends.string()));
  const Outcome run = toy.salbench("run", {"--threads", "2"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_GE(lines_of(log), 1U);
  EXPECT_LE(lines_of(log), 2U);
  EXPECT_EQ(lines_of(ends), lines_of(log)) << "each came to the end of its list";
}

// Serves one shape after the other: the number of each point's line, as kCount. `first` is done where the
// shape has 162 points, with $out as the file to write, and `each` for all when they are done.
std::string serving(const Workspace& toy, const std::string& first, const std::string& each = ":") {
  const fs::path script =
      toy.write("serve.sh", fmt::format(R"sh(while IFS="$(printf '\t')" read -r mesh out; do
  n=$(grep -a -m1 'element vertex' "$mesh" | cut -d' ' -f3)
  if [ "$n" = 162 ]; then {}; fi
  seq "$n" > "$out"
  echo "$out"
  {}
done < "$1"
)sh",
                                        first, each));
  return starts_counted(toy / "log", fmt::format("sh '{}' {{list}}", script.string()));
}

class HostileListCommand : public testing::TestWithParam<Hostile> {};

TEST_P(HostileListCommand, FailsItsShapeAloneAndTheNextOneIsServed) {
  const Workspace toy;
  const std::string mark = (toy / "mark").string();
  write_toy_item(toy.data(), "3", shapes::bumpy_sphere(3));
  toy.configure(command_config(
      fmt::format("timeout: {}, gpu: 1, command: \"{}\"", GetParam().timeout,
                  serving(toy, fmt::format(fmt::runtime(GetParam().command), fmt::arg("mark", mark))))));
  expect_first_alone_to_fail(toy, toy.salbench("run"), GetParam().says);
  EXPECT_THAT(processes_with(mark), IsEmpty());
  EXPECT_THAT(processes_with((toy / "serve.sh").string()), IsEmpty());
  EXPECT_LE(lines_of(toy / "log"), 3U);
}
INSTANTIATE_TEST_SUITE_P(
    Command, HostileListCommand,
    testing::Values(Hostile{"Hangs", "echo loading; sh -c 'trap : TERM; while :; do sleep 1; done' '{mark}'",
                            "longer than its timeout of 5 s.*: loading", 5},
                    Hostile{"AnswersAnotherShape", "echo \"$out.npy\"; echo \" $out\"; sleep 1000",
                            "longer than its timeout", 5},
                    Hostile{"AnswersWithoutAFile", "echo no memory >&2; echo \"$out\"; continue",
                            "answered \\(its last lines: no memory\\) without a file"},
                    Hostile{"EndsWithoutAnAnswer", "exit 0", "ended without an answer"},
                    Hostile{"KillsItself", "sh -c 'sleep 1000' '{mark}' & kill -9 $$", "killed by signal 9"}),
    [](const auto& test) { return test.param.name; });

// What prints no line that is an answer, and is thus waited for until its timeout.
class SilentListCommand : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(SilentListCommand, IsWaitedForThreeTimesAndNotForEachShape) {
  const Workspace toy;
  for (const int item : {3, 4, 5})
    write_toy_item(toy.data(), std::to_string(item), shapes::bumpy_sphere(2, 0.03 * item));
  const fs::path script = toy.write(
      "serve.sh", fmt::format("while read -r mesh out; do seq 162 > \"$out\"; {}; done", GetParam().second));
  toy.configure(command_config(
      fmt::format("timeout: 0.5, gpu: 1, command: \"{}\"",
                  starts_counted(toy / "log", fmt::format("sh '{}' < {{list}}", script.string())))));
  const Outcome run = toy.salbench("run", {"--threads", "1"});
  EXPECT_EQ(run.status, 1) << run.err;
  EXPECT_EQ(lines_of(toy / "log"), 3U);
  EXPECT_THAT(lines_with(run.err, "flush its standard output"), SizeIs(5)) << run.err;
  EXPECT_THAT(lines_with(run.err, "was not asked any more: it has answered none of 3 shapes"), SizeIs(2));
}
INSTANTIATE_TEST_SUITE_P(Command, SilentListCommand,
                         testing::Values(std::pair("ThatDoesNotFlush", ":"),
                                         std::pair("ThatEndsNoLine", "printf %s \"$out\""),
                                         std::pair("ThatPrintsAnotherName", "basename \"$out\"")),
                         [](const auto& test) { return std::string(test.param.first); });

// Some shapes take longer than others, and whoever has answered flushes.
TEST(ListCommand, ThatHasAnsweredIsAskedForEachShape) {
  const Workspace toy;
  for (const int item : {3, 4, 5})
    write_toy_item(toy.data(), std::to_string(item), shapes::bumpy_sphere(2, 0.03 * item));
  const fs::path script = toy.write("serve.sh", fmt::format(R"sh(while read -r mesh out; do
  test -e '{0}' && sleep 100
  echo > '{0}'
  seq "$(grep -a -m1 'element vertex' "$mesh" | cut -d' ' -f3)" > "$out"
  echo "$out"
done)sh",
                                                            (toy / "answered").string()));
  toy.configure(
      command_config(fmt::format("timeout: 3, gpu: 1, command: \"sh '{}' < {{list}}\"", script.string())));
  const Outcome run = toy.salbench("run", {"--threads", "1"});
  EXPECT_EQ(run.status, 1) << run.err;
  EXPECT_THAT(lines_with(run.err, "longer than its timeout"), SizeIs(4)) << run.err;
}

// Each answer counts, and none of the shapes is to blame.
TEST(ListCommand, ThatEndsBadlyBetweenShapesFailsNoneOfThem) {
  const Workspace toy;
  write_toy_item(toy.data(), "3", shapes::bumpy_sphere(3));
  for (const std::string delay : {"", "sleep 0.3; "}) {  // before the next line is written, and after
    toy.forget_everything();
    fs::remove(toy / "log");
    toy.configure(command_config(
        fmt::format("gpu: 1, command: \"{}\"", serving(toy, ":", delay + "echo no more >&2; exit 3"))));
    const Outcome run = toy.salbench("run");
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(lines_of(toy / "log"), 3U);
    EXPECT_THAT(cells_of(toy.results(), "MINE"), SizeIs(3));
    EXPECT_THAT(lines_with(run.err, "warning: models.MINE: the command ended with status 3 after an answer"),
                SizeIs(1))
        << run.err;
  }
}

}  // namespace
}  // namespace salbench
