// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/machine.h"

#include <gtest/gtest.h>
#include <sched.h>

#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

TEST(GroupLimits, OfVersion2AreTheLowestUpToTheRoot) {
  const TemporaryFolder root;
  root.write("a/b/cpu.max", "max 100000\n");
  root.write("a/cpu.max", "150000 100000\n");
  root.write("cpu.max", "800000 100000\n");
  root.write("a/b/memory.max", "3000000000\n");
  root.write("a/memory.max", "max\n");
  const GroupLimits limits = group_limits("0::/a/b\n", root.path());
  EXPECT_EQ(limits.cores, 1.5);
  EXPECT_EQ(limits.memory_bytes, 3'000'000'000U);
}

TEST(GroupLimits, OfAContainerAreFoundAtTheMountedRoot) {
  const TemporaryFolder root;
  root.write("cpu.max", "200000 100000\n");
  EXPECT_EQ(group_limits("0::/docker/0123\n", root.path()).cores, 2);
}

TEST(GroupLimits, OfVersion1HaveAFileSystemPerController) {
  const TemporaryFolder root;
  root.write("cpu/job/cpu.cfs_quota_us", "50000\n");
  root.write("cpu/job/cpu.cfs_period_us", "100000\n");
  root.write("cpu/cpu.cfs_quota_us", "-1\n");
  root.write("cpu/cpu.cfs_period_us", "100000\n");
  root.write("memory/memory.limit_in_bytes", "9223372036854771712\n");  // none
  const GroupLimits limits = group_limits("4:memory:/job\n2:cpu,cpuacct:/job\n0::/\n", root.path());
  EXPECT_EQ(limits.cores, 0.5);
  EXPECT_EQ(limits.memory_bytes, 0U);
  root.write("memory/job/memory.limit_in_bytes", "1000000\n");
  EXPECT_EQ(group_limits("4:memory:/job\n", root.path()).memory_bytes, 1'000'000U);
}

TEST(GroupLimits, ThatNobodySetAreNone) {
  const TemporaryFolder root;
  const GroupLimits limits = group_limits("0::/\nno group\n", root.path());
  EXPECT_EQ(limits.cores, 0);
  EXPECT_EQ(limits.memory_bytes, 0U);
}

TEST(Cores, AreThoseOfTheAffinity) {
  cpu_set_t before, one;
  ASSERT_EQ(::sched_getaffinity(0, sizeof before, &before), 0);
  EXPECT_EQ(cores().allowed, CPU_COUNT(&before));
  int first = 0;
  while (!CPU_ISSET(first, &before)) ++first;
  CPU_ZERO(&one);
  CPU_SET(first, &one);
  ASSERT_EQ(::sched_setaffinity(0, sizeof one, &one), 0);
  const Cores pinned = cores();
  ::sched_setaffinity(0, sizeof before, &before);
  EXPECT_EQ(pinned.allowed, 1);
  EXPECT_GE(pinned.online, CPU_COUNT(&before));
}

TEST(Memory, IsReadFromTheSystemsTable) {
  const Memory memory = memory_of("MemTotal:       16 kB\nMemFree: 1 kB\nMemAvailable:    8 kB\n");
  EXPECT_EQ(memory.total_bytes, 16384U);
  EXPECT_EQ(memory.available_bytes, 8192U);
  EXPECT_EQ(memory_of("").available_bytes, 0U);
}

TEST(Machine, TellsMoreMemoryThanIsAvailable) {
  const Machine machine = this_machine();
  EXPECT_GT(machine.memory.available_bytes, 0U);
  EXPECT_GT(machine.memory.total_bytes, machine.memory.available_bytes);
  EXPECT_NE(machine.system.find("Linux"), std::string::npos);
}

}  // namespace
}  // namespace salbench
