// SPDX-License-Identifier: GPL-3.0-or-later
// Runs over a data set that the Python package lists and imports.
#include <csignal>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/e2e/workspace.h"
#include "tests/support/processes.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

constexpr int kItems = 6;

class Imports : public testing::Test {
 protected:
  Imports() {
    for (int item = 0; item < kItems; ++item) {
      const Mesh mesh = shapes::bumpy_sphere(1, 0.05 * item);
      toy_.write(fmt::format("data set/off/{}.off", item), off_text(mesh));
      std::string values = "a,b\n";
      for (std::size_t i = 0; i < mesh.vertices.size(); ++i) values += fmt::format("{},{}\n", i % 7, i % 5);
      toy_.write(fmt::format("data set/maps/{}.csv", item), values);
    }
    own_ = toy_.write(
        "own.yaml",
        "places: [{meshes: 'off/*', truth: {saliency: 'maps/{item}.csv'}}]\nvalues: {column: a}\n");
    toy_.configure(
        fmt::format("dataset: {{scans: false, layout: '{}'}}\nmodels: {{PS: , RS: }}\n", own_.string()));
  }
  // An interpreter that refuses one of the served commands.
  std::string without(const std::string& command) const {
    const fs::path file = toy_.write(
        "python.sh",
        fmt::format("#!/bin/sh\nfor word; do [ \"$word\" = {} ] && {{ echo refused >&2; exit 9; }}; "
                    "done\nexec {} \"$@\"\n",
                    command, kPython));
    fs::permissions(file, fs::perms::owner_all);
    return file.string();
  }
  // One whose importers get SIGKILL when they have read a line: the first, or all.
  std::string killed_in_the_middle(bool once) const {
    const fs::path file = toy_.write(
        "killed.sh",
        fmt::format("#!/bin/sh\nfor word; do [ \"$word\" = _import ] && {} && "
                    "{{ read -r line; kill -9 $$; }}; done\nexec {} \"$@\"\n",
                    once ? fmt::format("mkdir '{}' 2> /dev/null", (toy_ / "killed").string()) : "true",
                    kPython));
    fs::permissions(file, fs::perms::owner_all);
    return file.string();
  }
  Outcome run_with(const std::string& python, const std::string& verb,
                   const std::vector<std::string>& further = {}) const {
    std::vector<std::string> words = toy_.command(verb, further);
    words.insert(words.begin(), {"/usr/bin/env", "SALBENCH_PYTHON=" + python});
    return run_process(words);
  }

  Workspace toy_;
  fs::path own_;
};

TEST_F(Imports, AKillInTheMiddleIsResumedAndLeavesNoProcess) {
  ASSERT_EQ(toy_.salbench("run").status, 0);
  const auto contents = toy_.contents();
  toy_.forget_everything();
  const std::string mark = "SALBENCH_TEST_MARK=" + own_.string();  // seen in the environment of its processes
  std::vector<std::string> command = with_signal_at_rename(toy_.command("run"), "3 after", SIGKILL);
  command.insert(command.begin() + 1, mark);
  const Outcome killed = run_process(command);
  EXPECT_EQ(killed.status, 128 + SIGKILL) << killed.err;
  EXPECT_TRUE(soon([&] { return processes_with(mark, "environ").empty(); }));
  const Outcome resumed = toy_.salbench("run");
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_LT(toy_.computed(), contents.size());
  EXPECT_EQ(toy_.contents(), contents);
  EXPECT_THAT(toy_.left_over(), IsEmpty());
}

TEST_F(Imports, AnImporterThatSomebodyElseKillsIsReplacedOnce) {
  const Outcome sound = toy_.salbench("run");
  ASSERT_EQ(sound.status, 0) << sound.err;
  const std::string results = toy_.results();
  for (const bool once : {true, false}) {
    SCOPED_TRACE(once);
    toy_.forget_everything();
    const Outcome run = run_with(killed_in_the_middle(once), "run");
    EXPECT_EQ(run.status, once ? 0 : 1) << run.err;
    EXPECT_THAT(lines_with(run.err, ".off: its importer was ended from outside, twice: "),
                SizeIs(once ? 0 : kItems))
        << run.err;
    EXPECT_THAT(run.err, Not(HasSubstr("copy the file again")));
    EXPECT_EQ(toy_.results() == results, once);
  }
}

TEST_F(Imports, AnImporterThatCannotWriteBlamesNoFile) {
  const fs::path python = toy_.write(
      "limited.sh",
      fmt::format("#!/bin/sh\nfor word; do [ \"$word\" = _import ] && ulimit -f 1; done\nexec {} \"$@\"\n",
                  kPython));
  fs::permissions(python, fs::perms::owner_all);
  const Outcome run = run_with(python.string(), "run");
  EXPECT_EQ(run.status, 3) << run.err;
  EXPECT_THAT(run.err, HasSubstr(": its importer could not answer; its last lines: "));
  EXPECT_THAT(run.err,
              HasSubstr(": cannot be written: File too large; raise the limit on the size of files"));
  EXPECT_THAT(run.err, Not(HasSubstr("copy the file again")));
}

TEST_F(Imports, WhatIsInTheCacheNeedsNoImporter) {
  ASSERT_EQ(toy_.salbench("run").status, 0);
  const std::string results = toy_.results(), importer = without("_import");
  for (const char* verb : {"run", "plan", "gc"}) {
    const Outcome ended = run_with(importer, verb);
    EXPECT_EQ(ended.status, 0) << verb << ended.err;
  }
  EXPECT_EQ(run_with(importer, "plan", {"0", "import"}).status, 0);
  EXPECT_EQ(toy_.results(), results);
  toy_.forget_everything();
  EXPECT_EQ(run_with(importer, "plan").status, 0);
  const Outcome run = run_with(importer, "run");
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(lines_with(run.err, "its importer failed: "), SizeIs(kItems)) << run.err;
}

TEST_F(Imports, ACollectionWhoseListFailedRemovesNothing) {
  ASSERT_EQ(toy_.salbench("run").status, 0);
  const auto contents = toy_.contents();
  const Outcome crashed = run_with(without("_list"), "gc");
  EXPECT_EQ(crashed.status, 70) << crashed.err;
  EXPECT_THAT(crashed.err, HasSubstr("the list of the data set's items failed: "));
  toy_.write("own.yaml", "places: [{meshes: 'of/*'}]\n");
  EXPECT_EQ(toy_.salbench("gc").status, 2);
  EXPECT_EQ(toy_.contents(), contents);
}

TEST_F(Imports, WithoutPythonAreRefusedInOneLineThatNamesThePackage) {
  for (const char* verb : {"run", "plan", "gc"}) {
    const Outcome ended = run_with("/no/python", verb);
    EXPECT_EQ(ended.status, 2);
    EXPECT_THAT(lines_with(ended.err, ""), SizeIs(1)) << ended.err;
    EXPECT_THAT(ended.err, AllOf(HasSubstr("needs Python: /no/python: not found"),
                                 HasSubstr("install python3-salbench")));
  }
  const Workspace native(kMeshesOnly);
  std::vector<std::string> words = native.command("run");
  words.insert(words.begin(), {"/usr/bin/env", "SALBENCH_PYTHON=/no/python"});
  EXPECT_EQ(run_process(words).status, 0);
}

TEST_F(Imports, WithAnInterpreterThatIsNoneAreRefusedInOneLine) {
  for (const char* none : {"/bin/true", "/bin/cat", "/bin/echo"}) {
    const Outcome ended = run_with(none, "run");
    EXPECT_EQ(ended.status, 2) << none;
    EXPECT_THAT(lines_with(ended.err, ""), SizeIs(1)) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(std::string("needs Python: ") + none + ": is no Python; install"));
  }
}

TEST_F(Imports, AreVerifiedAndExportedAsOtherStages) {
  ASSERT_EQ(toy_.salbench("run").status, 0);
  EXPECT_EQ(toy_.salbench("verify", {"--deep"}).status, 0);
  EXPECT_EQ(toy_.salbench("export", {"--to", (toy_ / "all.h5").string()}).status, 0);
  EXPECT_THAT(toy_.salbench("plan", {"0", "import"}).out, HasSubstr("import"));
  EXPECT_THAT(toy_.salbench("plan").out, Not(HasSubstr("not in the cache")));
}

}  // namespace
}  // namespace salbench
