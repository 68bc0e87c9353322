// SPDX-License-Identifier: GPL-3.0-or-later
// Commands end with the program, however that ends.
#include <csignal>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "tests/e2e/workspace.h"
#include "tests/support/processes.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;

// Writes the number of each point's line: a saliency that any command can make.
constexpr const char* kCount = R"(n=$(grep -a -m1 'element vertex' {mesh} | cut -d' ' -f3); seq $n > {out})";

// However the program ends, no process of a command is left, and no scratch folder: of one that is kept at
// work, and of one per shape, in whatever group they are.
class EndOfTheProgram : public testing::TestWithParam<int> {};

TEST_P(EndOfTheProgram, EndsItsCommandsAndTheNextRunGoesOn) {
  const Workspace toy;
  const fs::path mark = toy / "mark";  // a program, so that its processes can be told from others
  fs::copy("/bin/sleep", mark);
  fs::create_directory(toy / "tmp");
  const std::string strays =
      toy.write("strays.sh", fmt::format(R"sh(trap '' HUP INT TERM
[ -e '{1}' ] && exit
'{0}' 1000 &
timeout 1000 '{0}' 1000 &
('{0}' 1000 > /dev/null 2>&1 &)
echo started >> '{2}'
wait
)sh",
                                         mark.string(), (toy / "quick").string(), (toy / "started").string()))
          .string();
  toy.configure(fmt::format(
      "dataset: {{scans: false}}\nmodels: {{EACH: {{command: \"sh '{0}'; {1}\", at_once: 1}}, LIST: "
      "{{command: \"sh '{0}'; /usr/bin/python3 '{2}' {{list.h5}}\", gpu: 1}}}}\n",
      strays, kCount, SALBENCH_OWN_MODEL));
  std::vector<std::string> command = toy.command("run");
  command.insert(command.begin(), {"/usr/bin/env", "TMPDIR=" + (toy / "tmp").string()});
  {
    Process process(command);
    ASSERT_TRUE(wait_until(process, [&] {
      return fs::exists(toy / "started") && lines_with(read_file(toy / "started"), "started").size() == 2;
    }));
    EXPECT_FALSE(fs::is_empty(toy / "tmp"));
    process.send(GetParam());
    const bool orderly = GetParam() == SIGTERM;
    EXPECT_EQ(process.wait().status, orderly ? 130 : 128 + GetParam());
    if (orderly) {
      EXPECT_THAT(processes_with(mark.string()), IsEmpty()) << "they end before the program does";
    }
  }
  EXPECT_TRUE(soon([&] { return processes_with(mark.string()).empty(); }));
  EXPECT_TRUE(soon([&] { return fs::is_empty(toy / "tmp"); }));
  toy.write("quick", "");
  const Outcome resumed = run_process(command);
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_TRUE(fs::is_empty(toy / "tmp"));
}
INSTANTIATE_TEST_SUITE_P(Command, EndOfTheProgram, testing::Values(SIGTERM, SIGKILL),
                         [](const auto& test) { return std::string(::sigabbrev_np(test.param)); });

}  // namespace
}  // namespace salbench
