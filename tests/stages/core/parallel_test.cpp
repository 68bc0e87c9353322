// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/parallel.h"

#include <atomic>
#include <chrono>
#include <ctime>
#include <mutex>
#include <thread>

#include <tbb/global_control.h>
#include <tbb/task_group.h>

#include "tests/support/test.h"

namespace salbench {
namespace {

using FirstAndLast = std::pair<std::size_t, std::size_t>;

std::set<FirstAndLast> ranges_of(std::size_t n, std::size_t grain) {
  std::set<FirstAndLast> ranges;
  std::mutex mutex;
  parallel_ranges(n, grain, [&](std::size_t first, std::size_t last) {
    const std::lock_guard lock(mutex);
    EXPECT_TRUE(ranges.emplace(first, last).second);
  });
  return ranges;
}

TEST(ParallelRanges, AreTheSameForAnyNumberOfThreads) {
  for (const std::size_t threads : {1U, 2U, 4U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    EXPECT_EQ(ranges_of(10, 4), (std::set<FirstAndLast>{{0, 4}, {4, 8}, {8, 10}}));
    EXPECT_EQ(ranges_of(8, 4), (std::set<FirstAndLast>{{0, 4}, {4, 8}}));
    EXPECT_EQ(ranges_of(3, 4), (std::set<FirstAndLast>{{0, 3}}));
    EXPECT_TRUE(ranges_of(0, 4).empty());
  }
}

TEST(ParallelRanges, AreDoneThoughTheRunAroundThemIsCancelled) {
  std::atomic<int> done = 0;
  tbb::task_group run;
  run.run([&] {
    run.cancel();
    parallel_ranges(100, 1, [&](std::size_t, std::size_t) { ++done; });
  });
  run.wait();
  EXPECT_EQ(done, 100);
}

TEST(ParallelRanges, PassAnExceptionOn) {
  EXPECT_THROW(parallel_ranges(100, 1, [](std::size_t, std::size_t) { throw std::runtime_error("one"); }),
               std::runtime_error);
}

double time_of_thread() {
  timespec time = {};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

void work_for(double seconds) {
  for (const double end = time_of_thread() + seconds; time_of_thread() < end;) continue;
}

TEST(ProcessorTime, IsThatOfAllWhoHelpedAndOfNoWaiting) {
  for (const std::size_t threads : {1U, 4U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const ProcessorTime whole;
    const double nothing = whole.seconds();
    {
      const ProcessorTime part;
      parallel_ranges(4, 1, [](std::size_t, std::size_t) {
        parallel_ranges(4, 1, [](std::size_t, std::size_t) { work_for(0.002); });
      });
      EXPECT_GE(part.seconds(), 16 * 0.002);
    }
    EXPECT_GE(whole.seconds(), 16 * 0.002);
    const double before = whole.seconds();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_LT(whole.seconds() - before, 0.1);
    EXPECT_LT(nothing, 0.1);
  }
}

}  // namespace
}  // namespace salbench
