// SPDX-License-Identifier: GPL-3.0-or-later
// A model that is a command: what it computes, when it is run, and what becomes of one that misbehaves.
#include <filesystem>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "io/shapes/ground_truth_file.h"
#include "tests/e2e/workspace.h"
#include "tests/support/processes.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

std::string command_config(const std::string& options, const std::string& others = "PS: , ") {
  return "dataset: {scans: false}\nmodels: {" + others + "MINE: {" + options + "}}\n";
}

// Writes the number of each point's line: a saliency that any command can make.
constexpr const char* kCount = R"(n=$(grep -a -m1 'element vertex' {mesh} | cut -d' ' -f3); seq $n > {out})";

// A command that first appends a line to a file, so that its runs can be counted.
std::string counted(const fs::path& log) {
  return fmt::format("command: \"echo run >> '{}'; {}\"", log.string(), kCount);
}

std::size_t lines_of(const fs::path& file) {
  return fs::exists(file) ? lines_with(read_file(file), "run").size() : 0;
}

std::vector<std::vector<std::string>> cells_of(const std::string& csv, const std::string& model) {
  std::vector<std::vector<std::string>> rows;
  for (const std::string& line : lines_with(csv, "," + model + ",")) {
    std::vector<std::string>& cells = rows.emplace_back();
    std::istringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  }
  return rows;
}

TEST(Command, ShapesThatAModelWasTrainedOnAreNamedInItsTablesAndNoKeyKnowsOfIt) {
  const auto config = [](const std::string& trained) {
    return command_config(fmt::format("command: \"{}\"{}", kCount, trained));
  };
  const Workspace toy(config(", trained_on: [1, elsewhere]"));
  const Outcome first = toy.salbench("run");
  ASSERT_EQ(first.status, 0) << first.err;
  const std::string remark =
      "MINE was trained on shapes that it is scored on here (1; 2 scored): its scores there do not say how "
      "it "
      "does on new shapes.";
  EXPECT_THAT(first.err, HasSubstr(remark));
  EXPECT_THAT(toy.results(), HasSubstr("# " + remark + "\n"));
  const Outcome same = toy.salbench("config");
  EXPECT_THAT(same.out, HasSubstr("trained_on: [\"1\", \"elsewhere\"]"));
  toy.configure(config(""));
  const Outcome again = toy.salbench("run");
  EXPECT_THAT(again.out, HasSubstr("; 0 artefacts computed"));
  EXPECT_THAT(toy.results(), Not(HasSubstr("trained on")));
}

// The vertices of an OFF file are its lines after the second.
TEST(Command, MayReadTheFileThatAShapeWasReadFromAndIsToldItsName) {
  const Workspace toy(
      command_config("command: \"echo {item} {source} >&2; n=$(sed -n 2p {source} | cut -d' ' -f1); "
                     "seq $n > {out}; test {item} != 2\""));
  const Outcome run = toy.salbench("run");
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(cells_of(toy.results(), "MINE"), SizeIs(1));
  EXPECT_THAT(run.err, ContainsRegex("2 /.*/2.off"));
  EXPECT_THAT(toy.salbench("run").err, Not(HasSubstr("1.off")));
}

TEST(Command, AModelInPythonEqualsTheBuiltInOne) {
  const Workspace toy(
      fmt::format("scan: {{step_degrees: 1}}\nmodels: {{PS: , MINE: {{command: "
                  "\"/usr/bin/python3 {} {{shape}} {{out}}\", reads: [fpfh]}}}}\n",
                  SALBENCH_PS_MODEL));
  const Outcome run = toy.salbench("run");
  ASSERT_EQ(run.status, 0) << run.err;
  const auto built_in = cells_of(toy.results(), "PS"), own = cells_of(toy.results(), "MINE");
  ASSERT_THAT(built_in, SizeIs(2 * (1 + 12)));
  ASSERT_EQ(own.size(), built_in.size());
  // The first score, the paper's AUC, draws negatives by the model's name: it is as near as its draws.
  constexpr std::size_t kAuc = 5;
  for (std::size_t i = 0; i < own.size(); ++i)
    for (std::size_t c = kAuc; c < own[i].size(); ++c)
      EXPECT_NEAR(std::stod(own[i][c]), std::stod(built_in[i][c]), c == kAuc ? 0.1 : 1e-4) << i << " " << c;

  ASSERT_EQ(toy.salbench("export", {"--format", "maps", "--to", (toy / "maps").string()}).status, 0);
  for (const auto& entry : fs::directory_iterator(toy / "maps/PS")) {
    const std::string name = entry.path().filename().string();
    const auto a = parse_values(read_file(entry.path()), name);
    const auto b = parse_values(read_file(toy / "maps/MINE" / name), name);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-6) << name << " " << i;
  }
  EXPECT_THAT(read_file(toy.out() / "significance.csv"), HasSubstr("PS,MINE"));
}

TEST(Command, IsNotRunAgainAndAChangedFileRerunsItAlone) {
  const Workspace toy;
  const fs::path log = toy / "log";
  const fs::path weights = toy.write("weights.txt", "1");
  toy.configure(command_config(counted(log) + fmt::format(", depends: [\"{}\"]", weights.string())));
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(lines_of(log), 2U);
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(lines_of(log), 2U);
  EXPECT_EQ(toy.computed(), 0U);

  toy.write("weights.txt", "2");
  EXPECT_THAT(toy.salbench("explain", {"1", "map.MINE"}).out, HasSubstr("weights.txt changed"));
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(lines_of(log), 4U);
  EXPECT_EQ(toy.computed(), 2U) << "the map of each mesh, and nothing else: the values are as before";

  fs::remove(weights);
  const Outcome missing = toy.salbench("run");
  EXPECT_EQ(missing.status, 2);
  EXPECT_THAT(missing.err, AllOf(HasSubstr("models.MINE.depends"), HasSubstr("weights.txt")));
}

// A program and what it reads of its own folder, by a way that leads around links.
struct Neighbour {
  const char* name;
  const char* program;  // a file, started with {mesh} and {out}
  const char* text;
  const char* neighbour;
  const char *first, *second;  // its text, and another
};

void PrintTo(const Neighbour& param, std::ostream* out) { *out << param.name; }

class NeighbourOfACommand : public testing::TestWithParam<Neighbour> {};

TEST_P(NeighbourOfACommand, IsNotThereUnlessItIsNamedAndThenCounts) {
  const Neighbour& it = GetParam();
  const Workspace toy;
  toy.write(it.program, it.text);
  toy.write(it.neighbour, it.first);
  const std::string interpreter = std::string(it.program).ends_with(".py") ? "/usr/bin/python3" : "sh";
  const auto configure = [&](const std::string& depends) {
    toy.configure(command_config(
        fmt::format("command: \"{} {} {{mesh}} {{out}}\", depends: [{}]", interpreter, it.program, depends)));
  };
  configure(it.program);
  const Outcome without = toy.salbench("run");
  EXPECT_EQ(without.status, 1);
  EXPECT_THAT(without.err, HasSubstr(fmt::format("{} is not in the command's folder", it.neighbour)));

  configure(fmt::format("{0}, ./{0}, {1}", it.program, it.neighbour));
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string scores = toy.results();
  toy.write(it.neighbour, it.second);
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_NE(toy.results(), scores);
}
constexpr const char* kByNumber = R"py(import re, sys
n = int(re.search(rb"element vertex (\d+)", open(sys.argv[1], "rb").read()).group(1))
open(sys.argv[2], "w").writelines(f"{i % k + i / n}\n" for i in range(n))
)py";
const std::string kImporting = std::string("from helper import k\n") + kByNumber;
const std::string kReading =
    std::string("import os\nk = int(open(os.path.dirname(os.path.realpath(__file__)) + '/k.txt').read())\n") +
    kByNumber;
INSTANTIATE_TEST_SUITE_P(
    Command, NeighbourOfACommand,
    testing::Values(Neighbour{"Imported", "predict.py", kImporting.c_str(), "helper.py", "k = 7", "k = 31"},
                    Neighbour{"BelowAFolder", "model/predict.py", kImporting.c_str(), "model/helper.py",
                              "k = 7", "k = 31"},
                    Neighbour{"ByItsRealPath", "predict.py", kReading.c_str(), "k.txt", "7", "31"},
                    Neighbour{
                        "ByTheShell", "predict.sh",
                        "set -e\nk=$(cat \"$(dirname \"$(readlink -f \"$0\")\")/k.txt\")\n"
                        "n=$(grep -a -m1 'element vertex' $1 | cut -d' ' -f3)\n"
                        "awk -v n=$n -v k=$k 'BEGIN {for (i = 0; i < n; ++i) print i % k + i / n}' > $2\n",
                        "k.txt", "7", "31"}),
    [](const auto& test) { return test.param.name; });

TEST(Command, ThatGivesAnotherMapEachTimeIsToldSoWhereOneWasDamaged) {
  const Workspace toy(
      command_config("command: \"n=$(grep -a -m1 'element vertex' {mesh} | cut -d' ' -f3); s=$(date +%N); "
                     "awk -v n=$n -v s=$s 'BEGIN {srand(s); while (n-- > 0) print rand()}' > {out}\""));
  ASSERT_EQ(toy.salbench("run").status, 0);
  for (const fs::path& file : toy.artefacts("map.MINE")) {
    std::string bytes = read_file(file);
    bytes.back() ^= 1;
    write_file(file, bytes);
  }
  fs::remove_all(toy.cache() / "matched.MINE");
  const Outcome damaged = toy.salbench("run");
  EXPECT_EQ(damaged.status, 1) << damaged.err;
  EXPECT_THAT(damaged.err, HasSubstr("map.MINE was damaged, and the model gives another map each time"));
  EXPECT_THAT(damaged.err, Not(HasSubstr("a defect of salbench")));
  const Outcome again = toy.salbench("run");
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.computed(), 0U);
}

TEST(Command, TheConfigurationOfARunIsReadBack) {
  const Workspace toy(command_config(R"(command: 'seq 162 > {out} # "{mesh}" \')"));
  const auto config = [&] { return run_process({SALBENCH_PROGRAM, "config", toy.config().string()}).out; };
  const std::string printed = config();
  ASSERT_THAT(printed, HasSubstr("  MINE:"));
  toy.configure(printed);
  EXPECT_EQ(config(), printed);
}

// With one short line that says why; the other items go on.
void expect_first_alone_to_fail(const Workspace& toy, const Outcome& run, const std::string& says) {
  EXPECT_EQ(run.status, 1) << run.err;
  const auto lines = lines_with(run.err, "error: 1: map.MINE: ");
  ASSERT_THAT(lines, SizeIs(1)) << run.err;
  EXPECT_THAT(lines[0], ContainsRegex(says));
  EXPECT_LT(lines[0].size(), 6000U);
  EXPECT_THAT(cells_of(toy.results(), "MINE"), SizeIs(1));
  EXPECT_THAT(lines_with(toy.results(), ",PS,"), SizeIs(3));
}

struct Hostile {
  const char* name;
  const char* command;
  const char* says;   // a regular expression
  int timeout = 600;  // seconds; where it is to pass as few as a sound command never needs
};

void PrintTo(const Hostile& param, std::ostream* out) { *out << param.name; }

class HostileCommand : public testing::TestWithParam<Hostile> {};

TEST_P(HostileCommand, FailsItsItemWithAClearLineAndLeavesNothing) {
  const Workspace toy;
  const std::string mark = (toy / "mark").string();  // seen in the command lines of its processes
  const std::string first_only =
      fmt::format("if [ $(grep -a -m1 'element vertex' {{mesh}} | cut -d' ' -f3) = 162 ]; then {}; fi",
                  fmt::format(fmt::runtime(GetParam().command), fmt::arg("mark", mark)));
  write_toy_item(toy.data(), "3", shapes::bumpy_sphere(3));
  toy.configure(command_config(
      fmt::format("timeout: {}, command: \"{}; {}\"", GetParam().timeout, first_only, kCount)));
  expect_first_alone_to_fail(toy, toy.salbench("run"), GetParam().says);
  EXPECT_THAT(processes_with(mark), IsEmpty());
}
INSTANTIATE_TEST_SUITE_P(
    Command, HostileCommand,
    testing::Values(
        Hostile{"Hangs", "echo loading; sh -c 'trap : TERM; while :; do sleep 1; done' '{mark}'",
                "longer than its timeout of 5 s.*: loading", 5},
        Hostile{"WritesTooFew", "seq 7 > {{out}}; exit 0", "7 values, but the shape has 162 points"},
        Hostile{
            "WritesHdf5OfAnotherShape",
            "/usr/bin/python3 -c 'import h5py, numpy, sys; h5py.File(sys.argv[1], \\\"w\\\")[\\\"x\\\"] = "
            "numpy.zeros((81, 2))' {{out.h5}}; exit 0",
            "its shape is \\(81, 2\\), expected one value per point"},
        Hostile{"KillsItself", "sh -c 'sleep 1000' '{mark}' & kill -9 $$", "killed by signal 9"}),
    [](const auto& test) { return test.param.name; });

// Everything at once was killed, as a batch system does.
TEST(Command, ScratchThatNobodyCouldRemoveIsRemovedByALaterRun) {
  const Workspace toy(command_config(fmt::format("command: \"{}\"", kCount)));
  toy.write("tmp/salbench-scratch-00c0ffee00c0ffee/shape.ply", "ply");
  std::vector<std::string> command = toy.command("run");
  command.insert(command.begin(), {"/usr/bin/env", "TMPDIR=" + (toy / "tmp").string()});
  const Outcome run = run_process(command);
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_TRUE(fs::is_empty(toy / "tmp"));
}

TEST(Command, RunsInAScratchFolderBelowARelativeTmpdir) {
  const Workspace toy(command_config(fmt::format("command: \"{}\"", kCount)));
  const Outcome expected = toy.salbench("run");
  ASSERT_EQ(expected.status, 0) << expected.err;
  const std::string results = toy.results();
  toy.forget_everything();
  fs::create_directories(toy / "here/tmp");
  std::vector<std::string> command = toy.command("run");
  command.insert(command.begin(), {"/usr/bin/env", "--chdir=" + (toy / "here").string(), "TMPDIR=tmp"});
  const Outcome run = run_process(command);
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(toy.results(), results);
  EXPECT_TRUE(fs::is_empty(toy / "here/tmp"));
}

// --- a command that is kept at work ------------------------------------------------------------------------

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

// --- limits and refusals -----------------------------------------------------------------------------------

// Each run holds a folder as long as it is at work, and complains if another holds it.
TEST(Command, NoMoreAreAtWorkAtOnceThanTheLimitSays) {
  const Workspace toy;
  const std::string busy = (toy / "busy").string();
  const std::string alone = fmt::format("mkdir '{0}' || exit 9; {1}; sleep 0.05; rmdir '{0}'", busy, kCount);
  toy.configure("scan: {step_degrees: 1}\nmodels: {MINE: {gpu: 1, command: \"" + alone + "\"}}\n");
  const Outcome run = toy.salbench("run", {"--threads", "4"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(lines_with(toy.results(), ",MINE,"), SizeIs(2 * (1 + 12)));
}

TEST(Command, WhatCannotBeMeantIsRefusedBeforeTheRun) {
  const auto refused = [](const std::string& options) {
    const Workspace toy(command_config(options));
    const Outcome run = toy.salbench("run");
    EXPECT_EQ(run.status, 2) << options;
    return run.err;
  };
  EXPECT_THAT(refused("command: 'cat {mesh}'"), HasSubstr("models.MINE.command must have {out}"));
  EXPECT_THAT(refused("command: 'date > {out}'"), HasSubstr("must have {mesh}, {shape} or {source}"));
  EXPECT_THAT(refused("command: 'x {mesh} {out}', reads: [fpfh]"), HasSubstr("must have {shape}"));
  EXPECT_THAT(refused("command: 'x {mesh} {out}', reads: [colour]"), HasSubstr("names 'colour'"));
  EXPECT_THAT(refused("command: 'x {mesh} {out}', timeout: 0"),
              HasSubstr("timeout must be a number above 0"));
  EXPECT_THAT(refused("command: 'x {list} {out}'"),
              HasSubstr("must not have {mesh}, {shape}, {out}, {source} or {item}"));
  EXPECT_THAT(refused("command: 'x {list}', reads: [fpfh]"), HasSubstr("must have {list.h5}"));
  EXPECT_THAT(refused("command: 'x {list} {list.h5}'"), HasSubstr("both {list} and {list.h5}"));
  for (const char* taken : {"shape.ply", "./shape.ply", "out.val.npy"})
    EXPECT_THAT(refused(fmt::format("command: 'x {{mesh}} {{out}}', depends: [{}]", taken)),
                HasSubstr("which salbench writes itself"));
  EXPECT_THAT(refused("timeout: 1"), HasSubstr("models.MINE is not a known key"));
}

}  // namespace
}  // namespace salbench
