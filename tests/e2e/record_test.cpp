// SPDX-License-Identifier: GPL-3.0-or-later
// run.yaml says what was run: on which data, with which folders.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "tests/e2e/workspace.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::SizeIs;

std::string data_line(const Workspace& toy, const std::vector<std::string>& further = {}) {
  EXPECT_EQ(toy.salbench("run", further).status, 0);
  const auto lines = lines_with(read_file(toy.out() / "run.yaml"), "data_set: ");
  EXPECT_THAT(lines, SizeIs(1));
  return lines.at(0);
}

std::string digest_in(const std::string& line) { return line.substr(line.find("digest: ") + 8, 32); }

TEST(Record, IdentifiesTheDataByItsContent) {
  const Workspace toy(kMeshesOnly);
  const std::string line = data_line(toy);
  EXPECT_THAT(line, HasSubstr("folder: \"" + toy.data().string() + "\""));
  EXPECT_THAT(line, HasSubstr("layout: schelling, meshes: 2, files: 12, "))
      << "2 x (mesh, saliency, 4 participants)";
  const fs::path elsewhere = toy / "copy";
  fs::copy(toy.data(), elsewhere, fs::copy_options::recursive);
  EXPECT_EQ(digest_in(data_line(toy, {"--data", elsewhere.string()})), digest_in(line)) << "wherever it lies";
  EXPECT_NE(digest_in(data_line(toy, {"--items", "1"})), digest_in(line));
  toy.write("copy/RawData/2_1.pid", "3\n");
  EXPECT_NE(digest_in(data_line(toy, {"--data", elsewhere.string()})), digest_in(line));
}

// The recorded configuration alone, without any folder on the command line, is the same run.
TEST(Record, TheConfigurationNamesItsFolders) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string results = toy.results(), record = read_file(toy.out() / "run.yaml");
  std::string yaml;
  for (const std::string& line : lines_with(record.substr(record.find("\nconfiguration:\n") + 1), "  "))
    yaml += line.substr(2) + "\n";
  toy.configure(yaml);
  fs::remove_all(toy.out());
  const Outcome again = run_process({SALBENCH_PROGRAM, "run", toy.config().string()});
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(toy.computed(), 0U);
  EXPECT_EQ(toy.results(), results);
}

}  // namespace
}  // namespace salbench
