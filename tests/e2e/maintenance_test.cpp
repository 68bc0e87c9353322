// SPDX-License-Identifier: GPL-3.0-or-later
// verify and gc on the command line.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/e2e/workspace.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::SizeIs;

// The verbs know neither --out nor --threads.
Outcome maintain(const Workspace& toy, const std::string& verb,
                 const std::vector<std::string>& further = {}) {
  std::vector<std::string> words = {SALBENCH_PROGRAM,    verb,      toy.config().string(), "--data",
                                    toy.data().string(), "--cache", toy.cache().string()};
  words.insert(words.end(), further.begin(), further.end());
  return run_process(words);
}

TEST(Maintenance, VerifyCountsASoundCacheAndNamesABadArtefact) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string count = std::to_string(toy.artefacts().size()) + " artefacts";
  const Outcome sound = maintain(toy, "verify", {"--deep", "--sample", "5"});
  EXPECT_EQ(sound.status, 0) << sound.out;
  EXPECT_THAT(sound.out, testing::AllOf(HasSubstr(count), HasSubstr(": 0 bad"),
                                        HasSubstr("5 of its jobs computed again: 0 came out otherwise")));

  const fs::path bad = toy.artefacts("fpfh").front();
  std::fstream(bad, std::ios::in | std::ios::out).put('x');
  const Outcome damaged = run_process({SALBENCH_PROGRAM, "verify", "--cache", toy.cache().string()});
  EXPECT_EQ(damaged.status, 1);
  EXPECT_THAT(lines_with(damaged.out, bad.string()), SizeIs(1));
  EXPECT_THAT(damaged.out, HasSubstr(": 1 bad"));
  EXPECT_TRUE(fs::exists(bad)) << "nothing is moved";
}

TEST(Maintenance, ADryRunSaysWhatGcThenRemoves) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::size_t all = toy.artefacts().size();
  toy.configure("dataset: {scans: false}\nmodels: {RS: }\n");
  const Outcome dry = maintain(toy, "gc", {"--dry-run"});
  EXPECT_EQ(dry.status, 0) << dry.err;
  EXPECT_EQ(toy.artefacts().size(), all);
  const Outcome real = maintain(toy, "gc");
  EXPECT_EQ(real.status, 0) << real.err;
  const std::string removed = std::to_string(all - toy.artefacts().size()) + " artefacts";
  EXPECT_THAT(dry.out, HasSubstr("would be removed: " + removed));
  EXPECT_THAT(real.out, HasSubstr("\nremoved: " + removed));
  EXPECT_THAT(toy.artefacts("map.PS"), SizeIs(0));
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.computed(), 0);
}

TEST(Maintenance, WithoutAScopeNothingIsTouched) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run").status, 0);
  const auto before = toy.artefacts();
  const std::string cache = toy.cache().string();
  EXPECT_EQ(run_process({SALBENCH_PROGRAM, "gc", "--cache", cache}).status, 2);
  EXPECT_EQ(run_process({SALBENCH_PROGRAM, "verify"}).status, 2);
  EXPECT_EQ(run_process({SALBENCH_PROGRAM, "verify", "--deep", "--cache", cache}).status, 2);
  EXPECT_EQ(toy.artefacts(), before);

  const std::string other = (toy.write("elsewhere/damaged/mine", "x")).parent_path().parent_path().string();
  for (const char* verb : {"verify", "gc"})
    EXPECT_EQ(run_process({SALBENCH_PROGRAM, verb, toy.config().string(), "--data", toy.data().string(),
                           "--cache", other})
                  .status,
              3)
        << verb;
  EXPECT_TRUE(fs::exists(other + "/damaged/mine"));
}

}  // namespace
}  // namespace salbench
