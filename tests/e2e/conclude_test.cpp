// SPDX-License-Identifier: GPL-3.0-or-later
// Conclusions from the scores of a run: when they are drawn, and what becomes of a run without them.
#include <csignal>
#include <map>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "io/file.h"
#include "io/table.h"
#include "pipeline/run/results_folder.h"
#include "tests/e2e/workspace.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;

constexpr const char* kFails = "raise RuntimeError('no room')\n";
constexpr const char* kMissing = "raise ModuleNotFoundError(\"No module named 'scipy'\", name='scipy')\n";

// Files of conclusions in the folder of results.
std::vector<std::string> conclusions_of(const Workspace& toy) {
  std::vector<std::string> found;
  for (const std::string& name : files_of_conclusions())
    if (fs::exists(toy.out() / name)) found.push_back(name);
  return found;
}

TEST(Conclude, WritesTheFilesThatTheEngineRemoves) {
  const fs::path package = fs::path(SALBENCH_PROGRAM).parent_path() / "python";
  const Outcome written =
      run_process({"/usr/bin/env", "PYTHONPATH=" + package.string(), kPython, "-P", "-B", "-c",
                   "from salbench.conclusions import TABLES, folders\n"
                   "print(folders.CONCLUDED, *(f'{table.name}.csv' for table in TABLES), sep='\\n')"});
  EXPECT_EQ(written.status, 0) << written.err;
  EXPECT_THAT(files_of_conclusions(), testing::UnorderedElementsAreArray(lines_with(written.out, "")));
  EXPECT_EQ(files_of_conclusions().front(), "conclusions.json")
      << "first: what says that all the others are whole";
}

TEST(Conclude, ARerunWithNothingToDoNeedsNoLibraryOfThem) {
  const Workspace toy;
  const Outcome first = toy.salbench("run");
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_THAT(conclusions_of(toy),
              AllOf(Contains("conclusions.json"), Contains("summary.csv"), Contains("chance.csv")));
  EXPECT_THAT(first.out, HasSubstr("\nOn 2 meshes, PS is the only model"));
  const std::string summary = toy.summary();
  const Outcome again =
      run_process(toy.with_module("pandas", kFails, toy.with_module("scipy", kFails, toy.command("run"))));
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_THAT(again.err, Not(HasSubstr("conclusions")));
  const auto sentences = [](const std::string& text) { return text.substr(0, text.find("maps of ")); };
  EXPECT_EQ(sentences(again.out), sentences(first.out));
  EXPECT_EQ(toy.summary(), summary);
}

TEST(Conclude, ATableThatIsGoneOrNotWhatWasWrittenIsWrittenAgain) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const auto conclusions = [&] {
    std::map<std::string, std::string> texts;
    for (const std::string& name : conclusions_of(toy)) texts[name] = read_file(toy.out() / name);
    return texts;
  };
  const auto written = conclusions();
  for (const char* table : {"ranking.csv", "summary.csv", "chance.csv"}) {
    const std::string& text = written.at(table);
    for (const std::string& damaged :
         {text.substr(0, 100), std::string(), text + "x\n", text.substr(0, text.size() - 2) + "~\n"}) {
      toy.write("out" / fs::path(table), damaged);
      ASSERT_EQ(toy.salbench("run").status, 0);
      EXPECT_EQ(conclusions(), written) << table;
    }
    for (const bool pipe : {false, true}) {  // or nothing in its place
      fs::remove(toy.out() / table);
      if (pipe) {
        ASSERT_EQ(::mkfifo((toy.out() / table).c_str(), 0600), 0);
      }
      ASSERT_EQ(toy.salbench("run").status, 0);
      EXPECT_EQ(conclusions(), written) << table;
    }
  }
  toy.write("out/conclusions.json", std::string(100'000, '['));
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(conclusions(), written);
}

TEST(Conclude, TablesThatAreStaleGoBeforeNewScoresAreWritten) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  for (const std::string& name : files_of_conclusions())
    toy.write("out" / fs::path(name), "of an earlier run");
  toy.configure("models: {PS: , LS: , RS: }\n");
  EXPECT_EQ(run_process(toy.without_conclusions(toy.command("run"))).status, 0);
  EXPECT_THAT(conclusions_of(toy), IsEmpty());
  EXPECT_THAT(toy.results(), HasSubstr(",LS,"));
  toy.configure("models: {PS: , LS: , RS: }\nstatistics: {unit: shape}\n");
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string summary = toy.summary();
  toy.configure("models: {PS: , LS: , RS: }\n");
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_NE(toy.summary(), summary) << "the unit is a part of what they are of";
}

TEST(Conclude, WithoutALibraryMeansAreShownAndItIsNamed) {
  const Workspace toy;
  const auto without = [&](const std::vector<std::string>& command) {
    return run_process(toy.with_module("scipy", kMissing, command));
  };
  const Outcome run = without(toy.command("run"));
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.out, AllOf(StartsWith("dataset  metric     model  n     mean\n"),
                             HasSubstr("\nprotocol published")));
  EXPECT_THAT(lines_with(run.err, "conclusions:"),
              ElementsAre(AllOf(StartsWith("warning: no conclusions: "), HasSubstr("scipy"))));
  EXPECT_THAT(read_csv(toy.out() / "means.csv").rows, SizeIs(2 * 2 * 5));
  EXPECT_THAT(conclusions_of(toy), Not(Contains("conclusions.json")));
  EXPECT_THAT(without(toy.command("run", {"--format", "json"})).out,
              HasSubstr(R"("scores":[{"dataset":"meshes","metric":"auc","model":"PS","n":"2","mean":)"));
  for (const std::vector<std::string>& command :
       {toy.command("export", {"--to", (toy / "all.h5").string()}), toy.command("run", {"--shard", "1/2"})})
    EXPECT_EQ(without(command).status, 0);
  const Outcome concluded = without({SALBENCH_PROGRAM, "conclude", toy.out()});
  EXPECT_EQ(concluded.status, 2);
  EXPECT_THAT(lines_with(concluded.err, ""), ElementsAre(AllOf(StartsWith("error: "), HasSubstr("scipy"))));
  EXPECT_EQ(toy.salbench("run").status, 0);
  EXPECT_THAT(conclusions_of(toy), Contains("conclusions.json"));
}

TEST(Conclude, AFailureKeepsTheScoresAndIsSaid) {
  const Workspace toy;
  const Outcome run = run_process(toy.with_module("scipy", kFails, toy.command("run")));
  EXPECT_EQ(run.status, 70);
  EXPECT_THAT(run.err, AllOf(HasSubstr("the scores are there, but no conclusions"), HasSubstr("no room"),
                             HasSubstr("salbench conclude ")));
  EXPECT_THAT(toy.results(), HasSubstr(",PS,"));
  EXPECT_THAT(conclusions_of(toy), Not(Contains("conclusions.json")));
  EXPECT_EQ(toy.salbench("run").status, 0);
}

TEST(Conclude, AShardDoesNot) {
  const Workspace toy;
  EXPECT_EQ(run_process(toy.with_module("pandas", kFails, toy.command("run", {"--shard", "1/1"}))).status, 0);
  EXPECT_THAT(conclusions_of(toy), IsEmpty());
}

TEST(Conclude, EndedMeanwhileTheScoresAreThere) {
  const Workspace toy;
  const fs::path at_work = toy / "at work";
  const std::string slow =
      fmt::format("import time\nopen('{}', 'w').close()\ntime.sleep(1000)\n", at_work.string());
  for (const int signal : {SIGINT, SIGKILL}) {
    fs::remove(at_work);
    Process process(toy.with_module("scipy", slow, toy.command("run")));
    ASSERT_TRUE(wait_until(process, [&] { return fs::exists(at_work); }));
    process.send(signal);
    EXPECT_EQ(process.wait().status, signal == SIGINT ? 130 : 128 + signal);
    EXPECT_THAT(conclusions_of(toy), Not(Contains("conclusions.json")));
    EXPECT_THAT(toy.results(), HasSubstr(",PS,"));
  }
  EXPECT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.computed(), 0U);
}

// The user's own modules stay on the path, behind the package.
TEST(TheProgram, FindsItsOwnPackage) {
  const Workspace toy;
  std::vector<std::string> command =
      toy.with_module("salbench", "raise SystemExit('not this one')\n", {SALBENCH_PROGRAM, "--help"});
  command.insert(command.begin() + 1, "--chdir=" + (toy / "modules").string());
  const Outcome help = run_process(command);
  EXPECT_EQ(help.status, 0) << help.err;
}

}  // namespace
}  // namespace salbench
