// SPDX-License-Identifier: GPL-3.0-or-later
// Arguments and configurations: what is wrong is said in one line, and the exit status says who has to act.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "tests/e2e/workspace.h"
#include "tests/support/job_counts.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TEST(Usage, HelpAndVersionAreNoErrors) {
  const Outcome help = run_process({SALBENCH_PROGRAM, "--help"});
  EXPECT_EQ(help.status, 0);
  EXPECT_THAT(help.out, AllOf(HasSubstr("\n  run  "), HasSubstr("\n  plan  "), HasSubstr("\n  verify  "),
                              HasSubstr("\nExit status: 0 ")));
  EXPECT_THAT(
      run_process({SALBENCH_PROGRAM, "run", "--help"}).out,
      AllOf(HasSubstr("--data"), HasSubstr("--cache"), HasSubstr("--items"), HasSubstr("--reference")));
  const Outcome version = run_process({SALBENCH_PROGRAM, "--version"});
  EXPECT_EQ(version.status, 0);
  EXPECT_THAT(version.out,
              testing::MatchesRegex("salbench [0-9]+\\.[0-9]+\\.[0-9]+\n.*instructions [A-Z0-9_]+, "
                                    "oneTBB [0-9.]+.*, HDF5 [0-9.]+.*, Embree .*, CGAL .*\n"));
}

TEST(Usage, WordsThatTheProgramDoesNotKnow) {
  const Workspace toy(kMeshesOnly);
  EXPECT_EQ(run_process({SALBENCH_PROGRAM}).status, 2);
  EXPECT_EQ(run_process({SALBENCH_PROGRAM, "run"}).status, 2);
  EXPECT_EQ(toy.salbench("walk").status, 2);
  EXPECT_EQ(toy.salbench("run", {"--no-such-option"}).status, 2);
  EXPECT_EQ(toy.salbench("run", {"--threads", "0"}).status, 2);
  EXPECT_FALSE(fs::exists(toy.cache()) || fs::exists(toy.out()));
}

std::string said_of(const std::vector<std::string>& words) {
  std::vector<std::string> command = {SALBENCH_PROGRAM};
  command.insert(command.end(), words.begin(), words.end());
  const Outcome outcome = run_process(command);
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(lines_with(outcome.err, ""), SizeIs(1)) << outcome.err;
  return outcome.err;
}

TEST(Usage, AnUnknownWordGetsTheNearestKnownOne) {
  EXPECT_EQ(said_of({"rnu", "a.yaml"}), "error: there is no subcommand 'rnu'; did you mean 'run'?\n");
  EXPECT_EQ(said_of({"conclusions"}),
            "error: there is no subcommand 'conclusions'; did you mean 'conclude'?\n");
  EXPECT_EQ(said_of({"run", "a.yaml", "--item", "1"}),
            "error: run: there is no option '--item'; did you mean '--items'?\n");
  EXPECT_EQ(said_of({"run", "a.yaml", "--qiet"}),
            "error: run: there is no option '--qiet'; did you mean '--quiet'?\n");
  EXPECT_EQ(said_of({"frobnicate"}),
            "error: there is no subcommand 'frobnicate'; salbench --help names them\n");
  const Workspace toy;
  EXPECT_THAT(said_of({"plan", (toy / "tyo.yaml").string()}),
              EndsWith("there is no such configuration; did you mean 'toy'?\n"));
  toy.configure("models:\n  MINE: {comand: \"cp {mesh} {out}\"}\n");
  EXPECT_THAT(said_of({"plan", toy.config().string(), "--data", toy.data().string()}),
              EndsWith(":2: models.MINE.comand is not a known key; did you mean 'command'?\n"));
}

// Names of the subcommands, from the program's own help.
std::vector<std::string> subcommands_in(const std::string& help) {
  std::vector<std::string> names;
  const std::size_t begin = help.find("\nSubcommands:\n"), end = help.find("\nExamples:\n");
  for (const std::string& line : lines_with(help.substr(begin, end - begin), "  "))
    if (line[2] != ' ') names.push_back(line.substr(2, line.find(' ', 2) - 2));
  return names;
}

// The examples of a subcommand begin with its name, and name no option that it has not.
TEST(Usage, EverySubcommandHasExamples) {
  const std::string all = run_process({SALBENCH_PROGRAM, "--help"}).out;
  const std::vector<std::string> names = subcommands_in(all);
  ASSERT_THAT(names, Contains("run"));
  for (const std::string& name : names) {
    const Outcome help = run_process({SALBENCH_PROGRAM, name, "--help"});
    ASSERT_EQ(help.status, 0);
    const std::size_t begin = help.out.find("Examples:\n");
    ASSERT_NE(begin, std::string::npos) << name;
    const auto examples = lines_with(help.out.substr(begin), "  salbench ");
    ASSERT_FALSE(examples.empty()) << name;
    for (const std::string& line : examples) {
      EXPECT_THAT(line, testing::StartsWith(fmt::format("  salbench {}", name)));
      for (std::size_t at = line.find(" --"); at != std::string::npos; at = line.find(" --", at + 1)) {
        const std::string option = line.substr(at, line.find(' ', at + 1) - at);
        EXPECT_THAT(help.out.substr(0, begin), HasSubstr(option)) << line;
      }
    }
    EXPECT_THAT(all, HasSubstr(examples[0])) << name;
  }
}

// The one line on stderr; what is unusable from the start leaves nothing behind.
std::string complaint(const Workspace& toy, const std::vector<std::string>& further = {}) {
  const Outcome run = toy.salbench("run", further);
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(lines_with(run.err, ""), SizeIs(1)) << run.err;
  EXPECT_FALSE(fs::exists(toy.cache()) || fs::exists(toy.out()));
  return run.err;
}

TEST(Usage, AConfigurationThatIsWrongIsRefusedWithFileAndLine) {
  const Workspace toy("seed: 7\nscann: {step_degrees: 1}\n");
  EXPECT_THAT(complaint(toy), AllOf(HasSubstr(toy.config().string() + ":2: "), HasSubstr("'scan'")));
  toy.configure("seed: [1\n");
  EXPECT_THAT(complaint(toy), AllOf(HasSubstr(toy.config().string()), HasSubstr("YAML")));
}

TEST(Usage, AConfigurationThatIsNotThere) {
  const Workspace toy;
  fs::remove(toy.config());
  EXPECT_THAT(complaint(toy), AllOf(HasSubstr(toy.config().string()), HasSubstr("cannot be read")));
}

TEST(Usage, ADataFolderThatIsNotThereOrHoldsNoMesh) {
  const Workspace toy;
  EXPECT_THAT(complaint(toy, {"--data", "/no/such/folder"}), HasSubstr("/no/such/folder"));
  toy.write("empty/readme.txt", "no mesh");
  EXPECT_THAT(complaint(toy, {"--data", (toy / "empty").string()}), HasSubstr((toy / "empty").string()));
  EXPECT_EQ(complaint(toy, {"--data", ""}), "error: --data: is empty: name a file or a folder\n");
}

TEST(Usage, ItemsThatTheDataSetHasNot) {
  const Workspace toy;
  EXPECT_THAT(complaint(toy, {"--items", "1,7"}), AllOf(HasSubstr("--items"), HasSubstr("'7'")));
  EXPECT_THAT(complaint(toy, {"--items", "30-40"}), HasSubstr("30-40"));
  EXPECT_THAT(complaint(toy, {"--items", ","}), HasSubstr("no item"));
  EXPECT_THAT(complaint(toy, {"--split", "test"}), HasSubstr("split 'test': the data set has no splits"));
}

TEST(Usage, PlanChangesNothing) {
  const Workspace toy;
  const std::string results_line = "\nresults: " + toy.out().string() + "\n";
  const Outcome plan = toy.salbench("plan");
  EXPECT_EQ(plan.status, 0) << plan.err;
  EXPECT_THAT(plan.out, AllOf(HasSubstr("map.PS"), HasSubstr("jobs to do"), HasSubstr(results_line)));
  EXPECT_FALSE(fs::exists(toy.cache()) || fs::exists(toy.out()));

  ASSERT_EQ(toy.salbench("run").status, 0);
  const auto files = toy.files();
  const std::string results = toy.results();
  EXPECT_THAT(toy.salbench("plan").out,
              AllOf(HasSubstr("\n0 jobs to do"), HasSubstr("\nlast run: finished" + results_line)));
  EXPECT_EQ(toy.files(), files);
  EXPECT_EQ(toy.results(), results);
  EXPECT_THAT(toy.left_over(), IsEmpty());
}

// What the cache has of other configurations is a line, unless it is asked for.
TEST(Usage, PlanListsTheStagesOfItsConfiguration) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  toy.configure("dataset: {scans: false}\nmodels: {RS: }\n");
  const std::string own = toy.salbench("plan").out, all = toy.salbench("plan", {"--all"}).out;
  constexpr const char* kBeside = "also in the cache, of no stage of this configuration: ";
  EXPECT_THAT(lines_with(own, "map.RS "), SizeIs(1)) << own;
  EXPECT_THAT(lines_with(own, kBeside),
              testing::ElementsAre(
                  testing::ContainsRegex("[0-9]+ artefacts, [0-9.]+ MB, of .*map.PS, .*--all lists them")));
  EXPECT_THAT(lines_with(own, "\nmap.PS "), IsEmpty());
  EXPECT_THAT(own, testing::Not(HasSubstr("\nmap.PS ")));
  EXPECT_THAT(all, AllOf(HasSubstr("\nmap.PS "), HasSubstr("\nscan "), testing::Not(HasSubstr(kBeside))));
  toy.configure("models: {PS: , RS: }\n");
  EXPECT_EQ(toy.salbench("plan").out, toy.salbench("plan", {"--all"}).out);
}

// Who plans, exports or checks a run has seen it.
TEST(Usage, WhatIsOddAboutTheDataSetIsSaidByTheRunAlone) {
  const Workspace toy(kMeshesOnly);
  write_file(toy.data() / "Distributions/9.val", "1\n");
  constexpr const char* kNote = "9: ground truth without a mesh or point cloud";
  EXPECT_THAT(toy.salbench("plan").err, IsEmpty());
  EXPECT_THAT(lines_with(toy.salbench("run").err, kNote), SizeIs(1));
  EXPECT_THAT(lines_with(read_file(toy.out() / "run.yaml"), kNote), SizeIs(1));
  EXPECT_THAT(lines_with(toy.salbench("run").err, kNote), SizeIs(1)) << "of a run that computes nothing, too";
  const std::vector<std::pair<const char*, std::vector<std::string>>> others = {
      {"plan", {}},
      {"plan", {"--graph"}},
      {"plan", {"1", "map.PS"}},
      {"export", {"--to", (toy / "a.h5").string()}},
      {"verify", {}},
      {"gc", {}}};
  for (const auto& [verb, further] : others)
    EXPECT_THAT(toy.salbench(verb, further).err, testing::Not(HasSubstr(kNote))) << verb;
}

// The message of a folder that is not as the layout says; no shape is read for it.
TEST(Usage, TheLayoutThatFitsTheFolderIsNamed) {
  const Workspace toy(kMeshesOnly);
  fs::create_directories(toy / "gaze/Gaze");
  write_file(toy / "gaze/Gaze/cow.txt", "0 0 0 0 0 0 1 0\n");
  fs::create_directories(toy / "none");
  const auto refused = [&](const std::string& layout, const std::string& data) {
    toy.configure(fmt::format("dataset: {{layout: {}}}\n", layout));
    const Outcome ended =
        run_process({SALBENCH_PROGRAM, "run", toy.config().string(), "--data", (toy / data).string(),
                     "--cache", toy.cache().string(), "--out", toy.out().string()});
    EXPECT_EQ(ended.status, 2) << layout << ended.err;
    return ended.err;
  };
  for (const char* layout : {"schelling", "folder", "princeton", "meshmamba", "automatic"})
    EXPECT_THAT(refused(layout, "gaze"),
                HasSubstr("; layouts that fit: sal3d, sal3d_spread; choose one with dataset: {layout: ...}"))
        << layout;
  EXPECT_THAT(refused("sal3d", "data set"), HasSubstr("; layouts that fit: "));
  for (const char* layout : {"schelling", "sal3d"})
    EXPECT_THAT(refused(layout, "none"), testing::Not(HasSubstr("that fit")));
}

TEST(Usage, DescriptionsInYamlSayWhatHasTakenTheirPlace) {
  const Workspace toy("dataset: {layout: own.yaml}\n");
  toy.write("own.yaml", "places: [{meshes: 'off/*'}]\n");
  for (const char* verb : {"run", "plan"}) {
    const Outcome refused = toy.salbench(verb);
    EXPECT_EQ(refused.status, 2) << refused.err;
    EXPECT_THAT(lines_with(refused.err, ""),
                testing::ElementsAre(HasSubstr("own.yaml: data sets are no longer described in YAML: write a "
                                               "file of Python in its place (docs/upgrading.md shows how)")));
  }
  const Outcome inspected = run_process({SALBENCH_PROGRAM, "inspect", "own.yaml", "--data", "x"});
  EXPECT_EQ(inspected.status, 2);
  EXPECT_THAT(inspected.err, HasSubstr("data sets are no longer described in YAML"));
}

TEST(Usage, FormerNamesSayWhatHasTakenTheirPlace) {
  for (const char* name : {"convert", "doctor", "evaluate", "graph", "maps", "pictures", "power", "status"}) {
    for (const std::vector<std::string>& further :
         {std::vector<std::string>{"x.yaml", "--to", "y"}, {"--help"}}) {
      std::vector<std::string> words = {SALBENCH_PROGRAM, name};
      words.insert(words.end(), further.begin(), further.end());
      const Outcome former = run_process(words);
      EXPECT_EQ(former.status, 2) << name;
      EXPECT_THAT(former.err,
                  testing::StartsWith(fmt::format("error: there is no {} any more: salbench ", name)));
    }
  }
}

TEST(Usage, ConfigPrintsAConfigurationThatIsTheSameRun) {
  const Workspace toy;
  const Outcome printed = run_process({SALBENCH_PROGRAM, "config", toy.config().string()});
  ASSERT_EQ(printed.status, 0) << printed.err;
  EXPECT_THAT(printed.out, HasSubstr("  # nearest points, the point itself included (points; >= 2)\n"));
  ASSERT_EQ(toy.salbench("run").status, 0);
  toy.configure(printed.out);
  EXPECT_THAT(toy.salbench("plan").out, HasSubstr("\n0 jobs to do"));
  EXPECT_EQ(run_process({SALBENCH_PROGRAM, "config", toy.config().string()}).out, printed.out);

  const Outcome defaults = run_process({SALBENCH_PROGRAM, "config"});
  EXPECT_EQ(defaults.status, 0);
  EXPECT_THAT(defaults.out, AllOf(HasSubstr("protocol: published\n"), HasSubstr("\n  HS:\n")));
}

TEST(Usage, GraphCountsWhatEachNodeHasToDo) {
  const Workspace toy;
  const auto lines = [&](const std::vector<std::string>& further) {
    std::vector<std::string> words = {"--graph"};
    words.insert(words.end(), further.begin(), further.end());
    const Outcome graph = toy.salbench("plan", words);
    EXPECT_EQ(graph.status, 0) << graph.err;
    return graph.out;
  };
  EXPECT_THAT(lines({}), HasSubstr("\nfpfh of scans (version 1, one per scan, 24 to do) <- scan of scans, "
                                   "scan_normals of scans; read back: scan of scans\n"));
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_THAT(lines({}), HasSubstr("\nreference of meshes (version 1, one per set, 0 to do) <- ground_truth "
                                   "of meshes\n"));
  EXPECT_THAT(lines({"--format", "dot"}), testing::StartsWith("digraph salbench {"));
  EXPECT_EQ(run_process({SALBENCH_PROGRAM, "plan", toy.config().string(), "--format", "dot"}).status, 2);
  EXPECT_EQ(toy.salbench("plan", {"--graph", "--out", (toy / "x").string()}).status, 2);
  EXPECT_THAT(run_process({SALBENCH_PROGRAM, "plan", toy.config().string(), "--graph"}).out,
              testing::Not(HasSubstr("to do")));
}

TEST(Usage, QuietMeansWarningsAndErrorsOnly) {
  const Workspace toy(kMeshesOnly);
  const Outcome run = toy.salbench("run", {"--quiet"});
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.out, IsEmpty());
  for (const std::string& line : lines_with(run.err, "")) EXPECT_THAT(line, testing::StartsWith("warning: "));
}

TEST(Usage, WhatTakesLongSaysHowFarItIs) {
  const Workspace toy(kMeshesOnly);
  const auto says = [&](const std::vector<std::string>& command, const std::string& line) {
    const Outcome outcome = run_process(command);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(lines_with(outcome.err, line), SizeIs(1)) << outcome.err;
  };
  const JobCounts jobs(kMeshesOnly);
  const std::size_t of_reference = jobs.of("mesh") + jobs.of("ground_truth") + jobs.of("reference");
  says(toy.command("run"), fmt::format("evaluation: {0}/{0} jobs", jobs.all() - of_reference));
  says(toy.command("export", {"--format", "maps", "--to", (toy / "maps").string()}), "writing: 2/2 items");
  says(toy.command("export", {"--to", (toy / "all.h5").string()}), "exporting: 2/2 items");
  says(toy.command("export", {"--to", (toy / "shapes").string(), "--format", "ply"}), "exporting: 2/2 items");
  const std::string n = std::to_string(toy.files().size()), all = n + "/" + n + " items";
  says({SALBENCH_PROGRAM, "verify", "--cache", toy.cache().string()}, "verifying: " + all);
  says(toy.command("gc"), "collecting: " + all);
}

}  // namespace
}  // namespace salbench
