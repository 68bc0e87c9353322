#include "pipeline/flow.h"

#include <stdexcept>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/meeting.h"

namespace salbench {
namespace {

const std::atomic<bool> kGoOn = false;

TEST(Flow, EveryFamilyAndPartRunsOnceBetweenItsOpenAndClose) {
  for (const int threads : {1, 2, 8}) {
    constexpr int kFamilies = 200;
    std::vector<std::atomic<int>> state(kFamilies);  // 1: open, then + 10 a part
    std::vector<int> closed(kFamilies, 0);
    stream_families(
        kFamilies, {threads, threads + 1}, kGoOn,
        {.open =
             [&](int f) {
               state[static_cast<std::size_t>(f)] += 1;
               return f % 14;  // also families without parts
             },
         .part = [&](int f, int) { state[static_cast<std::size_t>(f)] += 10; },
         .close = [&](int f) { closed[static_cast<std::size_t>(f)] = state[static_cast<std::size_t>(f)]; }});
    for (int f = 0; f < kFamilies; ++f)
      EXPECT_EQ(closed[static_cast<std::size_t>(f)], 1 + 10 * (f % 14)) << f;
  }
}

TEST(Flow, PartsOfOneFamilyRunAtTheSameTime) {
  Meeting both(2);
  stream_families(1, {.threads = 2, .families_alive = 1}, kGoOn,
                  {.open = [](int) { return 2; },
                   .part = [&](int, int) { EXPECT_TRUE(both.join()); },
                   .close = [](int) {}});
  EXPECT_TRUE(both.met());
}

TEST(Flow, PartsOfDifferentFamiliesRunAtTheSameTime) {
  Meeting both(2);
  stream_families(2, {.threads = 2, .families_alive = 2}, kGoOn,
                  {.open = [](int) { return 1; },
                   .part = [&](int, int) { EXPECT_TRUE(both.join()); },
                   .close = [](int) {}});
  EXPECT_TRUE(both.met());
}

// One thread, the caller's, cannot do two things at once. The meeting gives another thread, were there one,
// the time to show itself.
TEST(Flow, WithOneThreadEverythingRunsInTheCallersThread) {
  const auto caller = std::this_thread::get_id();
  Meeting somebody_else(2, std::chrono::milliseconds(200));
  const auto expect_caller = [&] { EXPECT_EQ(std::this_thread::get_id(), caller); };
  stream_families(3, {.threads = 1, .families_alive = 2}, kGoOn,
                  {.open =
                       [&](int) {
                         expect_caller();
                         return 3;
                       },
                   .part =
                       [&](int, int) {
                         expect_caller();
                         somebody_else.join();
                       },
                   .close = [&](int) { expect_caller(); }});
  EXPECT_FALSE(somebody_else.met());
}

TEST(Flow, AsManyFamiliesAreAliveAsThereAreTokensAndNoMore) {
  std::atomic<int> alive = 0, most = 0;
  Meeting first_three(3);
  stream_families(300, {.threads = 4, .families_alive = 3}, kGoOn,
                  {.open =
                       [&](int) {
                         const int now = ++alive;
                         int seen = most;
                         while (now > seen && !most.compare_exchange_weak(seen, now)) {
                         }
                         return 5;
                       },
                   .part =
                       [&](int family, int part) {
                         if (family < 3 && part == 0) first_three.join();
                       },
                   .close = [&](int) { --alive; }});
  EXPECT_EQ(alive, 0);
  EXPECT_EQ(most, 3);
}

TEST(Flow, StopLetsOpenFamiliesCloseAndStartsNoOthers) {
  std::atomic<bool> stop = false;
  std::atomic<int> opened = 0, closed = 0;
  // One family at a time, so that how many are opened does not depend on who is quicker.
  stream_families(1000, {.threads = 2, .families_alive = 1}, stop,
                  {.open =
                       [&](int) {
                         if (++opened == 10) stop = true;
                         return 2;
                       },
                   .part = [](int, int) {},
                   .close = [&](int) { ++closed; }});
  EXPECT_EQ(opened, closed);
  EXPECT_GE(opened, 10);
  EXPECT_LE(opened, 11);  // one may stand at the gate
}

TEST(Flow, TheFirstExceptionComesOutAfterTheGraphHasRunDry) {
  std::atomic<int> opened = 0;
  const FlowBodies bodies{.open =
                              [&](int) {
                                ++opened;
                                return 3;
                              },
                          .part =
                              [](int f, int) {
                                if (f >= 5) throw std::runtime_error("disk full at " + std::to_string(f));
                              },
                          .close = [](int) {}};
  EXPECT_THROW(stream_families(1000, {.threads = 2, .families_alive = 3}, kGoOn, bodies), std::runtime_error);
  opened = 0;  // one at a time, the failure is known before the next could be opened
  EXPECT_THAT([&] { stream_families(1000, {.threads = 2, .families_alive = 1}, kGoOn, bodies); },
              testing::ThrowsMessage<std::runtime_error>("disk full at 5"));
  EXPECT_EQ(opened, 6);
}

TEST(Flow, NothingToDoIsFine) {
  int calls = 0;
  stream_families(0, {}, kGoOn,
                  {.open = [&](int) { return ++calls; },
                   .part = [&](int, int) { ++calls; },
                   .close = [&](int) { ++calls; }});
  EXPECT_EQ(calls, 0);
}

}  // namespace
}  // namespace salbench
