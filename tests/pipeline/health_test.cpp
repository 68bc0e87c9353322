// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/health.h"

#include <algorithm>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace salbench {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

Health sound() {
  Health health;
  health.version = "1.2.3";
  health.commit = "0123456789abcdef0123456789abcdef01234567 with changes";
  health.machine = {"Debian", {8, 4}, {16'000'000'000, 8'000'000'000}, {}};
  health.threads = 4;
  health.simd = "avx2";
  health.cache = "/data/cache";
  health.is_cache = true;
  health.disk = {"/data/cache", {"/data", "ext4", "rw"}, {50'000'000'000, 1'000'000}, true};
  health.trial = {0.002, 0.0001, true};
  health.temporary = "/tmp";
  health.temporary_free = {2'000'000'000, 1000};
  health.libraries = {{"A", "1.2", "1.2.0"}, {"B", "3", {}}};
  health.need = SpaceNeed{.artefacts = 100, .by_cache = 40, .files = 120, .bytes = 1'000'000'000};
  return health;
}

HealthLine line(const Health& health, const std::string& topic) {
  const std::vector<HealthLine> lines = lines_of(health);
  return *std::ranges::find(lines, topic, &HealthLine::topic);
}

TEST(Health, OfASoundMachineAreTenLinesWithoutAdvice) {
  const std::vector<HealthLine> lines = lines_of(sound());
  EXPECT_THAT(lines, SizeIs(10));
  for (const HealthLine& line : lines) {
    EXPECT_THAT(line.advice, IsEmpty()) << line.topic;
    EXPECT_THAT(line.text, AllOf(Not(IsEmpty()), Not(HasSubstr("\n")))) << line.topic;
  }
  EXPECT_EQ(line(sound(), "cores").text, "4 of 8 may be used; a run takes 4 threads");
  EXPECT_EQ(line(sound(), "disk").text, "fsync 2.00 ms, rename 0.10 ms");
  EXPECT_EQ(
      line(sound(), "space").text,
      "50.0 GB and 1000000 files free; the run needs about 1.0 GB in 120 files: 100 artefacts, of which "
      "40 are estimated by those of the cache, 60 by the sizes of shape files");
  EXPECT_EQ(line(sound(), "program").text,
            "salbench 1.2.3, commit 0123456789ab with changes, instructions avx2");
}

TEST(Health, NamesThreadsThatAControlGroupHoldsUp) {
  Health health = sound();
  health.machine.limits.cores = 2.5;
  EXPECT_THAT(line(health, "cores").text, HasSubstr("the control group grants 2.5"));
  EXPECT_THAT(line(health, "cores").advice, HasSubstr("--threads 3:"));
  health.threads = 3;
  EXPECT_THAT(line(health, "cores").advice, IsEmpty());
}

TEST(Health, TakesTheSmallerOfMemoryAndItsLimit) {
  Health health = sound();
  health.machine.limits.memory_bytes = 300'000'000;
  EXPECT_THAT(line(health, "memory").advice, HasSubstr("--threads"));
  health.machine.limits.memory_bytes = 600'000'000;
  EXPECT_THAT(line(health, "memory").advice, IsEmpty());
  health.machine.memory.available_bytes = 300'000'000;
  EXPECT_THAT(line(health, "memory").advice, HasSubstr("--threads"));
}

TEST(Health, OfADiskThatWillBeFullSaysWhatIsNeeded) {
  Health health = sound();
  health.disk.free.bytes = 900'000'000;
  EXPECT_THAT(line(health, "space").advice, HasSubstr("about 1.0 GB in 120 files, and 900.0 MB are free"));
  EXPECT_TRUE(can_run(health)) << "an estimate forbids nothing";
  health.need->artefacts = 0, health.need->bytes = 0, health.need->files = 0;
  EXPECT_EQ(line(health, "space").advice, "");
  EXPECT_THAT(line(health, "space").text, HasSubstr("nothing to compute"));
}

TEST(Health, OfACacheThatCannotBeWrittenToForbidsARunWithWork) {
  Health health = sound();
  health.disk.writable = false;
  EXPECT_THAT(line(health, "cache").advice, HasSubstr("--cache"));
  EXPECT_FALSE(can_run(health));
  health.need->artefacts = 0;
  EXPECT_TRUE(can_run(health)) << "a complete cache may be read-only";
  health.need.reset();
  EXPECT_FALSE(can_run(health));
}

TEST(Health, SaysWhoMayShareTheCache) {
  Health health = sound();
  EXPECT_EQ(line(health, "sharing").text, "locks hold: several processes may share the cache");
  health.disk.mount = {"/data", "nfs4", "rw,local_lock=none"};
  EXPECT_THAT(line(health, "sharing").text, HasSubstr("between machines they were not tried"));
  health.disk.mount.options = "rw,local_lock=all";
  EXPECT_THAT(line(health, "sharing").text, HasSubstr("not between machines"));
  EXPECT_THAT(line(health, "sharing").advice, HasSubstr("--shard"));
  health.trial.locks = false;
  EXPECT_THAT(line(health, "sharing").text, HasSubstr("repeat each other's work"));
  EXPECT_THAT(line(health, "sharing").advice, HasSubstr("one at a time"));
  health.trial.locks.reset();
  EXPECT_EQ(line(health, "sharing").text, "locks were not tried");
}

TEST(Health, NamesSlowRenamesAndFullTemporaryFolders) {
  Health health = sound();
  health.trial.rename_seconds = 0.03;
  EXPECT_THAT(line(health, "disk").advice, HasSubstr("local disk"));
  health.trial = {};
  EXPECT_EQ(line(health, "disk").text, "fsync not measured, rename not measured");
  health.temporary_free.bytes = 1000;
  EXPECT_THAT(line(health, "temporary").advice, HasSubstr("TMPDIR"));
}

TEST(Health, NamesLibrariesThatAreNotThoseItWasBuiltWith) {
  Health health = sound();
  EXPECT_EQ(line(health, "libraries").text, "A 1.2.0, B 3");
  health.libraries[0].loaded = "1.3.0";
  EXPECT_EQ(line(health, "libraries").text, "A 1.3.0 (built with 1.2), B 3");
}

}  // namespace
}  // namespace salbench
