// SPDX-License-Identifier: GPL-3.0-or-later
// Runs over a data set that the Python package lists, and whose files processes of their own read.
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
    own_ = toy_.write("own.py", R"(from salbench.datasets import Item, match, mesh, numbers

def items(root):
    return [Item(one.item, [one.path, f"{root}/maps/{one.item}.csv"]) for one in match(root, "off/{item}.off")]

def read(item):
    shape = mesh(item.files[0])
    shape.truth = numbers(item.files[1], ["a"])[:, 0]
    return shape
)");
    toy_.configure(
        fmt::format("dataset: {{scans: false, layout: '{}'}}\nmodels: {{PS: , RS: }}\n", own_.string()));
  }
  // In which Python does something first when it opens, or lists, what ends like this.
  Outcome with_trouble(const std::string& at, const std::string& what, const std::string& verb,
                       const std::vector<std::string>& further = {}) const {
    const std::string module = fmt::format(
        "import os, resource, signal, sys\n"
        "def look(event, words):\n"
        "    if event in ('open', 'os.scandir') and str(words[0]).endswith('{}'):\n        {}\n"
        "sys.addaudithook(look)\n",
        at, what);
    return run_process(toy_.with_module("sitecustomize", module, toy_.command(verb, further)));
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

TEST_F(Imports, AFileThatCrashesItsReaderFailsItsItemAlone) {
  const Outcome run = with_trouble("/3.off", "os.kill(os.getpid(), signal.SIGSEGV)", "run");
  EXPECT_EQ(run.status, 1) << run.err;
  EXPECT_THAT(lines_with(run.err, "error: "), testing::ElementsAre(HasSubstr("error: 3: import: ")))
      << run.err;
  EXPECT_THAT(lines_with(run.err, "3.off: read() of " + own_.string() + " crashed (signal 11"), SizeIs(1))
      << run.err;
  EXPECT_THAT(lines_with(toy_.results(), "meshes,"), SizeIs(2 * (kItems - 1)));
}

TEST_F(Imports, AReaderThatSomebodyElseKillsIsReplacedOnce) {
  const Outcome sound = toy_.salbench("run");
  ASSERT_EQ(sound.status, 0) << sound.err;
  const std::string results = toy_.results(), killed = (toy_ / "killed").string();
  for (const bool once : {true, false}) {
    SCOPED_TRACE(once);
    toy_.forget_everything();
    const std::string first = fmt::format("not os.path.exists('{0}') and not os.mkdir('{0}') and ", killed);
    const Outcome run =
        with_trouble("/3.off", (once ? first : "") + "os.kill(os.getpid(), signal.SIGKILL)", "run");
    EXPECT_EQ(run.status, once ? 0 : 1) << run.err;
    EXPECT_THAT(lines_with(run.err, "3.off: "), SizeIs(once ? 0 : 1)) << run.err;
    EXPECT_THAT(lines_with(run.err, " was ended from outside, twice "), SizeIs(once ? 0 : 1)) << run.err;
    EXPECT_THAT(run.err, Not(HasSubstr("damaged")));
    EXPECT_EQ(toy_.results() == results, once);
    EXPECT_THAT(lines_with(toy_.results(), "meshes,"), SizeIs(2 * (once ? kItems : kItems - 1)));
  }
}

TEST_F(Imports, AFileOfManyGigabytesFailsItsItemAlone) {
  fs::resize_file(toy_.data() / "maps/3.csv", std::uintmax_t{8} << 30U);
  const Outcome run = toy_.salbench("run");
  EXPECT_EQ(run.status, 1) << run.err;
  EXPECT_THAT(lines_with(run.err, "error: "),
              testing::ElementsAre(HasSubstr("maps/3.csv: 8589934592 bytes: at most 2147483648")))
      << run.err;
  EXPECT_THAT(lines_with(toy_.results(), "meshes,"), SizeIs(2 * (kItems - 1)));
}

TEST_F(Imports, AReaderThatMayOpenNoFileBlamesNone) {
  const Outcome run = with_trouble(".off", "resource.setrlimit(resource.RLIMIT_NOFILE, (3, 3))", "run");
  EXPECT_EQ(run.status, 3) << run.err;
  EXPECT_THAT(lines_with(run.err, "error: "),
              testing::ElementsAre(HasSubstr(".off: cannot be read: Too many open files; raise the limit")))
      << run.err;
  EXPECT_THAT(run.err, Not(HasSubstr("damaged")));
}

TEST_F(Imports, WhatIsInTheCacheIsNotReadAgain) {
  ASSERT_EQ(toy_.salbench("run").status, 0);
  const std::string results = toy_.results(), killed = "os.kill(os.getpid(), signal.SIGSEGV)";
  for (const char* verb : {"run", "plan", "gc"}) {
    const Outcome ended = with_trouble(".off", killed, verb);
    EXPECT_EQ(ended.status, 0) << verb << ended.err;
  }
  EXPECT_EQ(with_trouble(".off", killed, "plan", {"0", "import"}).status, 0);
  EXPECT_EQ(toy_.results(), results);
  toy_.forget_everything();
  EXPECT_EQ(with_trouble(".off", killed, "plan").status, 0);
  const Outcome run = with_trouble(".off", killed, "run");
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(lines_with(run.err, "crashed (signal 11"), SizeIs(kItems)) << run.err;
}

TEST_F(Imports, ACollectionWhoseListFailedRemovesNothing) {
  ASSERT_EQ(toy_.salbench("run").status, 0);
  const auto contents = toy_.contents();
  const Outcome crashed = with_trouble("/off", "raise RuntimeError('no list')", "gc");
  EXPECT_EQ(crashed.status, 2) << crashed.err;
  EXPECT_THAT(lines_with(crashed.err, "no list"), SizeIs(1)) << crashed.err;
  toy_.write("own.py", "def items(root):\n    return []\n");
  EXPECT_EQ(toy_.salbench("gc").status, 2);
  EXPECT_EQ(toy_.contents(), contents);
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
