// SPDX-License-Identifier: GPL-3.0-or-later
// What the program leaves to the Python package: conclusions from the scores of a run, and subcommands.
#include "pipeline/commands/conclude.h"

#include <csignal>
#include <map>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "io/file.h"
#include "io/table.h"
#include "pipeline/commands/cli.h"
#include "tests/e2e/workspace.h"
#include "tests/support/processes.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSubsetOf;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;

constexpr const char* kNoPython = "/no/python";

const fs::path kPackage = fs::path(SALBENCH_PROGRAM).parent_path() / "python";

// With another interpreter than the one that the program was built with.
std::vector<std::string> with_python(const std::string& python, std::vector<std::string> command) {
  command.insert(command.begin(), {"/usr/bin/env", "SALBENCH_PYTHON=" + python});
  return command;
}

// A shell script in place of an interpreter, which answers as one does: "$@" are the subcommand and its
// arguments.
std::string stand_in(const Workspace& toy, const std::string& script) {
  const fs::path file =
      toy.write("python.sh", "#!/bin/sh\n[ \"$1\" = -I ] && echo salbench 42 && exit\nshift 9\n" + script);
  fs::permissions(file, fs::perms::owner_all);
  return file.string();
}

// Files of conclusions in the folder of results.
std::vector<std::string> conclusions_of(const Workspace& toy) {
  std::vector<std::string> found;
  for (const std::string_view name : files_of_conclusions())
    if (fs::exists(toy.out() / name)) found.emplace_back(name);
  return found;
}

// Lines that the package prints for a line of Python.
std::vector<std::string> asked(const std::string& python) {
  const Outcome outcome =
      run_process({"/usr/bin/env", "PYTHONPATH=" + kPackage.string(), kPython, "-P", "-B", "-c", python});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return lines_with(outcome.out, "");
}

TEST(ThePackage, HasTheSubcommandsThatTheProgramNames) {
  CLI::App package;
  add_package(package);
  std::vector<std::string> named;
  for (const CLI::App* subcommand : package.get_subcommands({}))
    named.push_back(fmt::format("{}: {}", subcommand->get_name(), subcommand->get_description()));
  EXPECT_EQ(asked("from salbench.__main__ import SUBCOMMANDS\n"
                  "for name, made in SUBCOMMANDS.items(): print(f'{name}: {made.__doc__[0].lower()}"
                  "{made.__doc__[1:].rstrip(\".\")}')"),
            named);
  const std::string help = run_process({SALBENCH_PROGRAM, "--help"}).out;
  for (const std::string& line : named) EXPECT_THAT(help, HasSubstr(line.substr(line.find(": ") + 2)));
}

TEST(ThePackage, WritesTheFilesThatTheProgramRemoves) {
  const std::vector<std::string> written = asked(
      "from salbench.conclusions import TABLES, folders\n"
      "print(folders.CONCLUDED, *(f'{table.name}.csv' for table in TABLES), sep='\\n')");
  const auto& removed = files_of_conclusions();
  EXPECT_THAT(std::vector<std::string>(removed.begin(), removed.end()),
              testing::UnorderedElementsAreArray(written));
  EXPECT_EQ(removed.front(), "conclusions.json") << "first: what says that all the others are whole";
}

TEST(Conclude, ARerunWithNothingToDoStartsNoPython) {
  const Workspace toy;
  const Outcome first = toy.salbench("run");
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_THAT(conclusions_of(toy),
              AllOf(Contains("conclusions.json"), Contains("summary.csv"), Contains("chance.csv")));
  EXPECT_THAT(first.out, HasSubstr("\nOn 2 meshes, PS is the only model"));
  const std::string summary = toy.summary();
  const Outcome again = run_process(with_python(kNoPython, toy.command("run")));
  EXPECT_EQ(again.status, 0);
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
  for (const std::string_view name : files_of_conclusions())
    toy.write("out" / fs::path(name), "of an earlier run");
  toy.configure("models: {PS: , LS: , RS: }\n");
  const Outcome run = run_process(with_python(kNoPython, toy.command("run")));
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(conclusions_of(toy), IsEmpty());
  EXPECT_THAT(toy.results(), HasSubstr(",LS,"));
  toy.configure("models: {PS: , LS: , RS: }\nstatistics: {unit: shape}\n");
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string summary = toy.summary();
  toy.configure("models: {PS: , LS: , RS: }\n");
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_NE(toy.summary(), summary) << "the unit is a part of what they are of";
}

TEST(Conclude, WithoutPythonMeansAreShownAndThePackageIsNamed) {
  const Workspace toy;
  const Outcome run = run_process(with_python(kNoPython, toy.command("run")));
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.out, AllOf(StartsWith("dataset  metric     model  n     mean\n"),
                             HasSubstr("\nprotocol published")));
  EXPECT_THAT(lines_with(run.err, "conclusions:"),
              ElementsAre(AllOf(StartsWith("warning: no conclusions: /no/python: not found; "),
                                HasSubstr("install python3-salbench " SALBENCH_VERSION))));
  EXPECT_THAT(read_csv(toy.out() / "means.csv").rows, SizeIs(2 * 2 * 5));
  const Outcome document = run_process(with_python(kNoPython, toy.command("run", {"--format", "json"})));
  EXPECT_THAT(document.out,
              HasSubstr(R"("scores":[{"dataset":"meshes","metric":"auc","model":"PS","n":"2","mean":)"));
  for (const std::vector<std::string>& command :
       {toy.command("export", {"--to", (toy / "all.h5").string()}), toy.command("run", {"--shard", "1/2"})})
    EXPECT_EQ(run_process(with_python(kNoPython, command)).status, 0);
  const Outcome concluded = run_process(with_python(kNoPython, {SALBENCH_PROGRAM, "conclude", toy.out()}));
  EXPECT_EQ(concluded.status, 2);
  EXPECT_THAT(concluded.err, AllOf(HasSubstr("/no/python: No such file"), HasSubstr("python3-salbench"),
                                   HasSubstr("end with scores and their means")));
}

TEST(Conclude, WithoutALibraryOfPythonThePackageIsNamed) {
  const Workspace toy;
  toy.write("modules/scipy.py", "raise ModuleNotFoundError('no scipy', name='scipy')\n");
  const Outcome run = run_process([&] {
    std::vector<std::string> command = toy.command("run");
    command.insert(command.begin(), {"/usr/bin/env", "PYTHONPATH=" + (toy / "modules").string()});
    return command;
  }());
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.err, AllOf(HasSubstr("there is no module scipy"), HasSubstr("install python3-salbench")));
}

// A copy of the program, beside a package of another version.
TEST(Conclude, APackageOfAnotherVersionIsNamedWithWhatToDo) {
  const Workspace toy;
  fs::copy(SALBENCH_PROGRAM, toy / "salbench");
  toy.write("python/salbench/__init__.py", "__version__ = '0.0.1'\n");
  const Outcome concluded = run_process({(toy / "salbench").string(), "conclude", toy.out()});
  EXPECT_EQ(concluded.status, 2);
  EXPECT_THAT(concluded.err,
              AllOf(HasSubstr("package salbench is 0.0.1"),
                    HasSubstr("but the program is " SALBENCH_VERSION "; install python3-salbench")));
  std::vector<std::string> command = toy.command("run");
  command[0] = (toy / "salbench").string();
  const Outcome run = run_process(command);
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.err, HasSubstr("warning: no conclusions: error: "));
}

TEST(Conclude, AFailureKeepsTheScoresAndIsSaid) {
  const Workspace toy;
  const std::string fails = stand_in(toy, "echo 'no room' >&2; exit 3\n");
  const Outcome run = run_process(with_python(fails, toy.command("run")));
  EXPECT_EQ(run.status, 70);
  EXPECT_THAT(run.err, AllOf(HasSubstr("the scores are there, but no conclusions"), HasSubstr("status 3"),
                             HasSubstr("no room"), HasSubstr("salbench conclude ")));
  EXPECT_THAT(toy.results(), HasSubstr(",PS,"));
  EXPECT_THAT(conclusions_of(toy), IsEmpty());
  EXPECT_EQ(run_process(with_python(stand_in(toy, "exit 0\n"), toy.command("run"))).status, 70)
      << "it wrote nothing";
  EXPECT_EQ(toy.salbench("run").status, 0);
}

TEST(Conclude, AShardDoesNot) {
  const Workspace toy;
  const std::string fails = stand_in(toy, "exit 3\n");
  EXPECT_EQ(run_process(with_python(fails, toy.command("run", {"--shard", "1/1"}))).status, 0);
  EXPECT_THAT(conclusions_of(toy), IsEmpty());
}

TEST(Conclude, NothingOfItOutlivesTheProgram) {
  const Workspace toy;
  const fs::path mark = toy / "mark";  // a program, so that its processes can be told from others
  fs::copy("/bin/sleep", mark);
  const std::string slow =
      stand_in(toy, fmt::format("trap '' INT TERM\n(timeout 1000 '{0}' 1000 &)\ntouch '{1}'\n'{0}' 1000\n",
                                mark.string(), (toy / "at work").string()));
  for (const int signal : {SIGINT, SIGKILL}) {
    fs::remove(toy / "at work");
    Process process(with_python(slow, toy.command("run")));
    ASSERT_TRUE(wait_until(process, [&] { return fs::exists(toy / "at work"); }));
    process.send(signal);
    EXPECT_EQ(process.wait().status, signal == SIGINT ? 130 : 128 + signal);
    EXPECT_TRUE(soon([&] { return processes_with(mark.string()).empty(); }));
    EXPECT_THAT(conclusions_of(toy), IsEmpty());
  }
  EXPECT_EQ(toy.salbench("run").status, 0);
}

TEST(AHandedSubcommand, GetsItsWordsAndItsEndIsThatOfTheProgram) {
  const Workspace toy;
  const std::string echo = stand_in(toy, "printf '%s\\n' \"$@\"; exit 7\n");
  const Outcome echoed = run_process(with_python(echo, {SALBENCH_PROGRAM, "report", "a b", "--to", "'"}));
  EXPECT_EQ(echoed.status, 7);
  EXPECT_EQ(echoed.out, "report\na b\n--to\n'\n");
  const std::string killed = stand_in(toy, "kill -TERM $$\n");
  EXPECT_EQ(run_process(with_python(killed, {SALBENCH_PROGRAM, "report"})).status, 128 + SIGTERM);
  const Outcome help = run_process({SALBENCH_PROGRAM, "conclude", "--help"});
  EXPECT_EQ(help.status, 0) << help.err;
  EXPECT_THAT(help.out, AllOf(HasSubstr("\nUsage: salbench conclude "), HasSubstr("\n  --unit ")));
}

TEST(AHandedSubcommand, IsRefusedWhereTheInterpreterIsNone) {
  const Workspace toy;
  for (const char* none : {"/bin/true", "/bin/cat", "/bin/false", "/usr/bin/yes", "/usr/bin/env"}) {
    const Outcome handed = run_process(with_python(none, {SALBENCH_PROGRAM, "report", toy.out()}));
    EXPECT_EQ(handed.status, 2) << none;
    EXPECT_THAT(handed.err,
                AllOf(HasSubstr(std::string(none) + ": is no Python"), HasSubstr("SALBENCH_PYTHON")));
    EXPECT_THAT(lines_with(handed.err, ""), SizeIs(1)) << handed.err;
  }
  const Outcome run = run_process(with_python("/bin/true", toy.command("run")));
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.err, HasSubstr("warning: no conclusions: /bin/true: is no Python; install"));
}

// The user's own modules stay on the path, behind the package.
TEST(AHandedSubcommand, FindsThePackageOfThisBuildAndTheModulesOfTheUser) {
  const Workspace toy;
  toy.write("salbench/__init__.py", "raise SystemExit('not this one')\n");
  const Outcome help = run_process({"/usr/bin/env", "--chdir=" + toy.data().parent_path().string(),
                                    "PYTHONPATH=" + toy.data().parent_path().string(), SALBENCH_PROGRAM,
                                    "conclude", "--help"});
  EXPECT_EQ(help.status, 0) << help.err;
}

}  // namespace
}  // namespace salbench
