// SPDX-License-Identifier: GPL-3.0-or-later
// verify and gc on the command line.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/e2e/workspace.h"
#include "tests/support/cache_files.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::SizeIs;

TEST(Maintenance, VerifyCountsASoundCacheAndNamesABadArtefact) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string count = std::to_string(toy.artefacts().size()) + " artefacts";
  const Outcome sound = toy.salbench("verify", {"--deep", "--sample", "5"});
  EXPECT_EQ(sound.status, 0) << sound.out;
  EXPECT_THAT(sound.out, testing::AllOf(HasSubstr(count), HasSubstr(": 0 bad"),
                                        HasSubstr("5 of its jobs computed again: 0 came out otherwise")));

  damage(toy.cache(), "fpfh", "1");
  const fs::path bad = file_with(toy.cache(), "fpfh", "1");
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
  const Outcome dry = toy.salbench("gc", {"--dry-run"});
  EXPECT_EQ(dry.status, 0) << dry.err;
  EXPECT_EQ(toy.artefacts().size(), all);
  const Outcome real = toy.salbench("gc");
  EXPECT_EQ(real.status, 0) << real.err;
  const std::string removed = std::to_string(all - toy.artefacts().size()) + " artefacts";
  EXPECT_THAT(dry.out, HasSubstr("would be removed: " + removed));
  EXPECT_THAT(real.out, HasSubstr("\nremoved: " + removed));
  EXPECT_THAT(toy.artefacts("map.PS"), SizeIs(0));
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.computed(), 0);
}

TEST(Maintenance, StagesThatAreNamedAreRemovedAndNoOthers) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::size_t all = toy.artefacts().size(), maps = toy.artefacts("map.PS").size();
  const auto gc = [&](const std::vector<std::string>& words) {
    std::vector<std::string> command = {SALBENCH_PROGRAM, "gc"};
    command.insert(command.end(), words.begin(), words.end());
    return run_process(command);
  };
  const std::string cache = toy.cache().string();
  EXPECT_EQ(gc({"--cache", cache, "--stage", "map.PS"}).status, 0);
  EXPECT_THAT(toy.artefacts("map.PS"), SizeIs(0));
  EXPECT_EQ(toy.artefacts().size(), all - maps);
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.computed(), maps) << "what was made of them comes out as before";
  EXPECT_EQ(toy.salbench("gc", {"--stage", "map,fpfh"}).status, 0);
  EXPECT_THAT(toy.artefacts("map.RS"), SizeIs(0));
  EXPECT_THAT(toy.artefacts("fpfh"), SizeIs(0));
  EXPECT_GT(toy.artefacts("mesh").size(), 0U);
  const Outcome wrong = gc({"--cache", cache, "--stage", "maps"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("there is no stage 'maps'"));
  EXPECT_EQ(gc({"--stage", "map"}).status, 2);
  const Outcome elsewhere = gc({"--cache", toy.out().string(), "--stage", "map"});
  EXPECT_EQ(elsewhere.status, 3);
  EXPECT_THAT(elsewhere.err, HasSubstr("not a salbench cache"));
}

TEST(Maintenance, WithoutAScopeNothingIsTouched) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run").status, 0);
  const auto before = toy.files();
  const std::string cache = toy.cache().string();
  EXPECT_EQ(run_process({SALBENCH_PROGRAM, "gc", "--cache", cache}).status, 2);
  EXPECT_EQ(run_process({SALBENCH_PROGRAM, "verify"}).status, 2);
  EXPECT_EQ(run_process({SALBENCH_PROGRAM, "verify", "--deep", "--cache", cache}).status, 2);
  EXPECT_EQ(toy.files(), before);

  const std::string other = toy.write("elsewhere/mine", "x").parent_path().string();
  for (const char* verb : {"verify", "gc"})
    EXPECT_EQ(toy.salbench(verb, {"--cache", other}).status, 3) << verb;
  EXPECT_TRUE(fs::exists(other + "/mine"));
}

}  // namespace
}  // namespace salbench
