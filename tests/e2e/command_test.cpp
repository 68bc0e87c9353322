// SPDX-License-Identifier: GPL-3.0-or-later
// A model that is a command: what it computes, when it is run, and what becomes of one that misbehaves.
#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "io/shapes/values_file.h"
#include "tests/e2e/commands.h"
#include "tests/e2e/workspace.h"
#include "tests/support/cache_files.h"
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

// A command that first appends a line to a file, so that its runs can be counted.
std::string counted(const fs::path& log) {
  return fmt::format("command: \"echo run >> '{}'; {}\"", log.string(), kCount);
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
  EXPECT_THAT(toy.results(), HasSubstr("," + remark + "\n"));
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
  constexpr std::size_t kFirstScore = 5;
  for (std::size_t i = 0; i < own.size(); ++i)
    for (std::size_t c = kFirstScore; c < own[i].size(); ++c)
      EXPECT_NEAR(std::stod(own[i][c]), std::stod(built_in[i][c]), 1e-4) << i << " " << c;

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
  EXPECT_THAT(toy.salbench("plan", {"1", "map.MINE"}).out,
              ContainsRegex("\n  - .*weights.txt.*\n  [+] .*weights.txt"));
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(lines_of(log), 4U);
  EXPECT_EQ(toy.computed(), 2U) << "the map of each mesh, and nothing else: the values are as before";

  fs::remove(weights);
  const Outcome missing = toy.salbench("run");
  EXPECT_EQ(missing.status, 2);
  EXPECT_THAT(missing.err, AllOf(HasSubstr("models.MINE.depends"), HasSubstr("weights.txt")));
}

std::string with_name(std::string text, const std::string& name, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(name, at)) != std::string::npos; at += by.size())
    text.replace(at, name.size(), by);
  return text;
}

TEST(Command, ANewNameComputesNoMapAgainAndMovesNoScore) {
  const Workspace toy;
  const fs::path log = toy / "log";
  // Maps that differ from mesh to mesh: what is made of equal ones is equal, and found once.
  const std::string config = command_config(
      fmt::format("command: \"echo run >> '{}'; n=$(grep -a -m1 'element vertex' {{mesh}} | cut -d' ' -f3); "
                  "seq $n | sed s/$/.$(cksum < {{mesh}} | cut -c1-4)/ > {{out}}\"",
                  log.string()));
  toy.configure(config);
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string results = toy.results();

  toy.configure(with_name(config, "MINE", "YOURS"));
  EXPECT_THAT(toy.salbench("plan").out, Not(HasSubstr("map.YOURS  2 to compute")));
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(lines_of(log), 2U);
  EXPECT_EQ(toy.results(), with_name(results, "MINE", "YOURS"));
  ASSERT_EQ(toy.salbench("gc").status, 0);
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.computed(), 0U) << "gc keeps what is found under another name";

  lose(toy.cache(), "matched.YOURS");
  damage(toy.cache(), "map.MINE");
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(lines_of(log), 4U) << "what was damaged is made again";
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(lines_of(log), 4U);

  toy.configure(with_name(config, "PS: , MINE:", "MINE: {command: \"false {mesh} {out}\"}, AS_IT_WAS:"));
  EXPECT_EQ(toy.salbench("run").status, 1);
  EXPECT_EQ(lines_of(log), 4U) << "an earlier version under a name of its own, beside one that fails";
}

TEST(Command, OfOneRunNoneIsFoundUnderTheNameOfAnother) {
  const Workspace toy;
  const fs::path log = toy / "log";
  const std::string config = command_config(counted(log));
  toy.configure(with_name(config, "PS: ,", "OTHER: {" + counted(log) + "},"));
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(lines_of(log), 4U) << "or the number would depend on which comes first";
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
  lose(toy.cache(), "matched.MINE");
  damage_unseen(toy.cache(), "map.MINE");
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
        Hostile{"WritesNoNumber", "yes nan | head -n 162 > {{out}}; exit 0", "finite"},
        Hostile{"WritesBytes",
                "printf '0\\\\n\\\\177ELF\\\\002\\\\001\\\\000\\\\377\\\\376' > {{out}}; exit 0",
                "out.val:.*is not a number"},
        Hostile{"WritesNothing", "exit 0", "ended without a file"},
        Hostile{"WritesAFolder", "mkdir {{out}}; exit 0", "is a folder"},
        Hostile{"WritesAPipe", "mkfifo {{out}}; exit 0", "is not a regular file"},
        Hostile{"WritesGigabytes", "truncate -s 5G {{out}}; exit 0",
                "5368709120 bytes are too many for 162 values"},
        Hostile{"ClosesItsInput", "exec 0<&-; exec 1>&-; exit 3", "status 3"},
        Hostile{"RemovesItsInput", "rm {{mesh}}; exit 3", "status 3"},
        Hostile{"LeavesADaemon", "nohup sh -c 'sleep 1000' '{mark}' & exit 3", "status 3"},
        Hostile{
            "WritesHdf5OfAnotherShape",
            "/usr/bin/python3 -c 'import h5py, numpy, sys; h5py.File(sys.argv[1], \\\"w\\\")[\\\"x\\\"] = "
            "numpy.zeros((81, 2))' {{out.h5}}; exit 0",
            "its shape is \\(81, 2\\), expected one value per point"},
        Hostile{"WritesNpyOfAnotherShape",
                "/usr/bin/python3 -c 'import numpy, sys; numpy.save(sys.argv[1], numpy.zeros((81, 2)))' "
                "{{out.npy}}; exit 0",
                "out.npy: not a .npy file that can be read: its shape is \\(81, 2\\)"},
        Hostile{"KillsItself", "sh -c 'sleep 1000' '{mark}' & kill -9 $$", "killed by signal 9"}),
    [](const auto& test) { return test.param.name; });

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
  EXPECT_THAT(refused("timeout: 1"), HasSubstr("models.MINE is not a known model"));
}

TEST(Command, OneThatFailsAlikeOnTheFirstShapesIsNotTriedOnTheOthers) {
  const Workspace toy;
  const fs::path log = toy / "log";
  toy.configure(fmt::format(
      "scan: {{step_degrees: 1}}\nmodels: {{PS: , MINE: {{command: \"echo run >> '{}'; echo no such "
      "weights >&2; false {{mesh}} {{out}}\"}}}}\n",
      log.string()));
  const Outcome run = toy.salbench("run");  // two meshes with 12 scans each
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(lines_of(log), 5U);
  EXPECT_THAT(run.err,
              ContainsRegex("map.MINE: .*no such weights.*: failed alike on its first 5 items \\(1, 2, 1_0, "
                            "2_0, 1_1\\), and is not tried on the other 21; --keep-going tries all"));
  EXPECT_THAT(cells_of(toy.results(), "PS"), SizeIs(26));
  EXPECT_EQ(toy.salbench("run", {"--keep-going"}).status, 1);
  EXPECT_EQ(lines_of(log), 5U + 26U);
}

TEST(Command, WhoHasAModuleThatAnInterpreterLacksIsSaid) {
  const Workspace toy;
  const fs::path python =
      toy.write("python3", "echo \"ModuleNotFoundError: No module named 'numpy.linalg'\" >&2; exit 1\n");
  toy.configure(command_config(fmt::format("command: \"sh '{}' {{mesh}} {{out}}\"", python.string())));
  EXPECT_THAT(
      toy.salbench("run").err,
      ContainsRegex("No module named 'numpy.linalg'.*; /.*python3.* has numpy: start the command with it"));
}

}  // namespace
}  // namespace salbench
