// SPDX-License-Identifier: GPL-3.0-or-later
// The graph with rules that do nothing: which jobs run, when, and how many at once.
#include "pipeline/engine/graph.h"

#include <mutex>
#include <thread>

#include "tests/engine/toy.h"
#include "tests/support/meeting.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

const std::atomic<bool> kGoOn = false;

std::string nothing() { return {}; }
std::string of_one(const std::string&) { return {}; }
std::string of_two(const std::string&, const std::string&) { return {}; }
double of_all(const Members<std::string>&) { return 0; }

// text -> note, text -> word -> letter -> second letter, and a sum over all second letters.
struct GraphTest : testing::Test {
  GraphTest() {
    RuleTable table;
    const auto loaded = table.add(kTexts, {.stage = "text"}, nothing);
    text = loaded.rule().value();
    note = table.add(kTexts, {.stage = "letter"}, of_one, loaded).rule().value();
    const auto of_text = table.add(kWords, {.stage = "word"}, of_one, loaded);
    word = of_text.rule().value();
    const auto first = table.add(kWords, {.stage = "letter"}, of_one, of_text);
    letter = first.rule().value();
    const auto two = table.add(kWords, {.stage = "second"}, of_two, first, of_text);
    second = two.rule().value();
    sum = table.add(kWords, {.stage = "sum"}, of_all, two).rule().value();
    project.rules = std::move(table).take();
  }

  void run(std::size_t families, const GraphLimits& limits, GraphBodies bodies,
           const std::atomic<bool>& stop = kGoOn) {
    project.units = toy_units(families);
    if (!bodies.is_open) bodies.is_open = [](const Job&) { return true; };
    if (!bodies.enter_family) bodies.enter_family = [](std::size_t) { return true; };
    if (!bodies.leave_family) bodies.leave_family = [](std::size_t) {};
    const auto settle = bodies.settle_job;
    bodies.settle_job = [&, settle](const Job& job) {
      const bool settled = !settle || settle(job);
      const std::lock_guard lock(mutex);
      if (settled) order.push_back(job);
      return settled;
    };
    stream_jobs(project, limits, stop, bodies);
  }
  void run(std::size_t families, const GraphBodies& bodies = {}) { run(families, {2, 3}, bodies); }

  std::size_t settled(std::size_t rule) const {
    return static_cast<std::size_t>(
        std::count_if(order.begin(), order.end(), [&](const Job& job) { return job.rule == rule; }));
  }
  std::size_t place(const Job& job) const {
    return static_cast<std::size_t>(std::ranges::find(order, job) - order.begin());
  }

  std::size_t text = 0, note = 0, word = 0, letter = 0, second = 0, sum = 0;
  Project project;
  std::mutex mutex;
  std::vector<Job> order;
};

TEST_F(GraphTest, EveryJobIsFinishedOnceAfterEverythingItReads) {
  for (const int threads : {1, 2, 8}) {
    order.clear();
    constexpr std::size_t kFamilies = 50;
    run(kFamilies, {threads, threads + 1}, {});
    EXPECT_THAT(order, SizeIs(kFamilies * (2 + 3 * kWordsPerText) + 1));
    for (const Job& job : order)
      for (std::size_t i = 0; i < project.rule(job).inputs.size(); ++i)
        for (const Job& input : project.input_jobs(job, i)) ASSERT_LT(place(input), place(job));
  }
}

TEST_F(GraphTest, FinishedJobsAreNeitherDoneAgainNorWaitedFor) {
  const auto open = [&](const Job& job) {
    return job.rule == second && project.units.place(job.unit) % 2 == 0;
  };
  run(3, {.is_open = open});
  EXPECT_THAT(order, SizeIs(3 * 2));
  order.clear();
  run(3, {.is_open = [&](const Job& job) { return job.rule == sum; }});
  EXPECT_THAT(order, SizeIs(1));
  order.clear();
  run(3, {.is_open = [](const Job&) { return false; },
          .enter_family =
              [](std::size_t) {
                ADD_FAILURE() << "a family without work entered";
                return true;
              }});
  EXPECT_THAT(order, IsEmpty());
}

TEST_F(GraphTest, TwoRulesOfAFamilyTwoPartsOfAUnitAndTwoFamiliesRunAtTheSameTime) {
  const auto expect_at_once = [&](std::size_t families, const auto& is_one_of_two) {
    Meeting both(2);
    run(families, {.settle_job = [&](const Job& job) {
          EXPECT_TRUE(!is_one_of_two(job) || both.join());
          return true;
        }});
    EXPECT_TRUE(both.met());
  };
  const auto nth = [&](const Job& job) { return project.units.place(job.unit); };
  expect_at_once(1,
                 [&](const Job& job) { return job.rule == note || (job.rule == letter && nth(job) == 0); });
  expect_at_once(1, [&](const Job& job) { return job.rule == word && (nth(job) == 0 || nth(job) == 2); });
  expect_at_once(2, [&](const Job& job) { return job.rule == text; });
}

// One thread, the caller's, cannot run two jobs at once. The meeting would give another thread time to
// appear.
TEST_F(GraphTest, WithOneThreadEverythingRunsInTheCallersThread) {
  const auto caller = std::this_thread::get_id();
  Meeting somebody_else(2, std::chrono::milliseconds(200));
  run(2, {1, 2}, {.settle_job = [&](const Job& job) {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        if (job.rule == word) somebody_else.join();
        return true;
      }});
  EXPECT_FALSE(somebody_else.met());
}

TEST_F(GraphTest, ARuleWithALimitRunsNoMoreOftenAtATime) {
  project.rules[letter].limit = 1;
  std::atomic<int> at_work = 0;
  run(5, {8, 9}, {.settle_job = [&](const Job& job) {
        if (job.rule == letter) {
          EXPECT_EQ(++at_work, 1);
          std::this_thread::yield();
          --at_work;
        }
        return true;
      }});
  EXPECT_EQ(settled(letter), 5U * kWordsPerText);
}

// With one thread, priorities determine the order: a family is finished before the next begins.
TEST_F(GraphTest, LaterRulesGoFirst) {
  run(4, {1, 4}, {});
  std::vector<std::size_t> families;
  for (const Job& job : order)
    if (job.unit.level != kRoot && (families.empty() || families.back() != project.units.family_of(job.unit)))
      families.push_back(project.units.family_of(job.unit));
  EXPECT_THAT(families, ElementsAre(0, 1, 2, 3));
}

TEST_F(GraphTest, AsManyFamiliesAreInsideAsThereAreTokensAndNoMore) {
  std::atomic<int> inside = 0, most = 0;
  Meeting first_three(3);
  run(100, {4, 3},
      {.enter_family =
           [&](std::size_t) {
             const int now = ++inside;
             int seen = most;
             while (now > seen && !most.compare_exchange_weak(seen, now)) {
             }
             return true;
           },
       .settle_job =
           [&](const Job& job) {
             if (job.rule == text && project.units.family_of(job.unit) < 3) first_three.join();
             return true;
           },
       .leave_family = [&](std::size_t) { --inside; }});
  EXPECT_EQ(inside, 0);
  EXPECT_EQ(most, 3);
}

TEST_F(GraphTest, AFamilyThatCannotEnterKeepsItsJobsAndHoldsNobodyUp) {
  run(10, {2, 1}, {.enter_family = [](std::size_t family) { return family % 3 != 0; }});
  EXPECT_EQ(settled(second), 6U * kWordsPerText);
  EXPECT_EQ(settled(sum), 0U) << "its members are not all there";
}

TEST_F(GraphTest, AJobOfTheRootThatCannotBeDoneStaysOpen) {
  run(2, {.settle_job = [&](const Job& job) { return job.rule != sum; }});
  EXPECT_EQ(settled(sum), 0U);
  EXPECT_EQ(settled(second), 2U * kWordsPerText);
}

TEST_F(GraphTest, StopLetsTheJobsAtWorkEndAndStartsNoOthers) {
  std::atomic<bool> stop = false;
  std::atomic<int> jobs = 0, entered = 0, left = 0;
  run(100, {2, 2},
      {.enter_family = [&](std::size_t) { return ++entered, true; },
       .settle_job =
           [&](const Job&) {
             if (++jobs == 100) stop = true;
             return true;
           },
       .leave_family = [&](std::size_t) { ++left; }},
      stop);
  EXPECT_GE(jobs, 100);
  EXPECT_LE(jobs, 101);  // the other thread's
  EXPECT_EQ(entered, left);
}

TEST_F(GraphTest, TheFirstExceptionComesOutAfterTheGraphHasRunDry) {
  std::atomic<int> entered = 0, left = 0;
  const GraphBodies bodies{.enter_family = [&](std::size_t) { return ++entered, true; },
                           .settle_job =
                               [&](const Job& job) {
                                 if (job.rule == word && project.units.family_of(job.unit) >= 5)
                                   throw std::runtime_error("disk full");
                                 return true;
                               },
                           .leave_family = [&](std::size_t) { ++left; }};
  EXPECT_THAT([&] { run(1000, {2, 1}, bodies); }, ThrowsMessage<std::runtime_error>("disk full"));
  EXPECT_EQ(entered, left);
  EXPECT_EQ(entered, 6);
  EXPECT_EQ(settled(text), 6U);
}

TEST_F(GraphTest, NothingToDoIsFine) {
  run(0);
  EXPECT_THAT(order, ElementsAre(Job{sum, Unit{}}));
}

}  // namespace
}  // namespace salbench
