#include "pipeline/flow.h"

#include <numeric>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

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

TEST(Flow, NoMoreFamiliesAreAliveThanTokens) {
  std::atomic<int> alive = 0, most = 0;
  stream_families(300, {.threads = 4, .families_alive = 3}, kGoOn,
                  {.open =
                       [&](int) {
                         const int now = ++alive;
                         int seen = most;
                         while (now > seen && !most.compare_exchange_weak(seen, now)) {
                         }
                         return 5;
                       },
                   .part = [](int, int) { std::this_thread::yield(); },
                   .close = [&](int) { --alive; }});
  EXPECT_EQ(alive, 0);
  EXPECT_LE(most, 3);
  EXPECT_GE(most, 1);
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
                                if (f == 5) throw std::runtime_error("disk full");
                              },
                          .close = [](int) {}};
  EXPECT_THROW(stream_families(1000, {.threads = 2, .families_alive = 3}, kGoOn, bodies), std::runtime_error);
  opened = 0;  // one at a time, the failure is known before the next could be opened
  EXPECT_THROW(stream_families(1000, {.threads = 2, .families_alive = 1}, kGoOn, bodies), std::runtime_error);
  EXPECT_EQ(opened, 6);
}

TEST(Flow, NothingToDoIsFine) {
  stream_families(0, {}, kGoOn,
                  {.open = [](int) { return 0; }, .part = [](int, int) {}, .close = [](int) {}});
}

}  // namespace
}  // namespace salbench
