// SPDX-License-Identifier: GPL-3.0-or-later
// The graph over a catalog whose rows do nothing: which jobs are settled, when, and by how many at once.
#include "pipeline/run/graph.h"

#include <map>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/commands/graph.h"
#include "stages/scan/scan.h"
#include "tests/support/meeting.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::IsSupersetOf;
using testing::SizeIs;

const std::atomic<bool> kGoOn = false;

Mesh nothing() { return {}; }
ScalarField of_mesh(const Mesh&) { return {}; }
Scan scan_of_mesh(const Mesh&) { return {}; }
ScalarField of_scan(const Scan&) { return {}; }
ScalarField of_two(const ScalarField&, const Scan&) { return {}; }
Histogram of_all(const Members<ScalarField>&) { return {}; }

// mesh -> field, mesh -> scan -> field -> second field, and a mean over all second fields.
struct GraphTest : testing::Test {
  GraphTest() {
    const auto loaded = catalog.add(Shapes::meshes, {"mesh"}, nothing);
    mesh = loaded.row;
    mesh_field = catalog.add(Shapes::meshes, {"field"}, of_mesh, loaded).row;
    const auto scanned = catalog.add(Shapes::scans, {"scan"}, scan_of_mesh, loaded);
    scan = scanned.row;
    const auto field = catalog.add(Shapes::scans, {"field"}, of_scan, scanned);
    scan_field = field.row;
    const auto two = catalog.add(Shapes::scans, {"second"}, of_two, field, scanned);
    second = two.row;
    mean = catalog.add(Shapes::scans, {"mean"}, of_all, two).row;
  }

  void run(std::size_t families, const GraphLimits& limits, GraphBodies bodies,
           const std::atomic<bool>& stop = kGoOn) {
    workload.families.resize(families);
    if (!bodies.open) bodies.open = [](const JobRef&) { return true; };
    if (!bodies.enter) bodies.enter = [](std::size_t) { return true; };
    if (!bodies.leave) bodies.leave = [](std::size_t) {};
    const auto settle = bodies.settle;
    bodies.settle = [&, settle](const JobRef& job) {
      const bool settled = !settle || settle(job);
      const std::lock_guard lock(mutex);
      if (settled) order.push_back(job);
      return settled;
    };
    stream(context, limits, stop, bodies);
  }
  void run(std::size_t families, const GraphBodies& bodies = {}) { run(families, {2, 3}, bodies); }

  std::size_t settled(std::size_t row) const {
    return static_cast<std::size_t>(
        std::count_if(order.begin(), order.end(), [&](const JobRef& job) { return job.row == row; }));
  }
  std::size_t place(const JobRef& job) const {
    return static_cast<std::size_t>(std::find(order.begin(), order.end(), job) - order.begin());
  }

  Catalog catalog;
  std::size_t mesh = 0, mesh_field = 0, scan = 0, scan_field = 0, second = 0, mean = 0;
  Workload workload;
  Context context{catalog, workload};
  std::mutex mutex;
  std::vector<JobRef> order;
};

TEST_F(GraphTest, EveryJobIsSettledOnceAfterEverythingItReads) {
  for (const int threads : {1, 2, 8}) {
    order.clear();
    constexpr std::size_t kFamilies = 50;
    run(kFamilies, {threads, threads + 1}, {});
    EXPECT_THAT(order, SizeIs(kFamilies * (2 + 3 * kViews) + 1));
    for (const JobRef& job : order)
      for (std::size_t i = 0; i < context.row(job).inputs.size(); ++i)
        for (const JobRef& input : input_jobs(context, job, i)) ASSERT_LT(place(input), place(job));
  }
}

TEST_F(GraphTest, SettledJobsAreNeitherDoneAgainNorWaitedFor) {
  const auto open = [&](const JobRef& job) { return job.row == second && job.item.view % 2 == 0; };
  run(3, {.open = open});
  EXPECT_THAT(order, SizeIs(3 * kViews / 2));
  order.clear();
  run(3, {.open = [&](const JobRef& job) { return job.row == mean; }});
  EXPECT_THAT(order, SizeIs(1));
  order.clear();
  run(3, {.open = [](const JobRef&) { return false; },
          .enter =
              [](std::size_t) {
                ADD_FAILURE() << "a family without work entered";
                return true;
              }});
  EXPECT_THAT(order, IsEmpty());
}

TEST_F(GraphTest, TwoRowsOfOneShapeRunAtTheSameTime) {
  Meeting both(2);
  run(1, {.settle = [&](const JobRef& job) {
        if (job.row == mesh_field || (job.row == scan_field && job.item.view == 0)) {
          EXPECT_TRUE(both.join());
        }
        return true;
      }});
  EXPECT_TRUE(both.met());
}

TEST_F(GraphTest, TwoScansOfAMeshRunAtTheSameTime) {
  Meeting both(2);
  run(1, {.settle = [&](const JobRef& job) {
        if (job.row == scan && (job.item.view == 4 || job.item.view == 9)) {
          EXPECT_TRUE(both.join());
        }
        return true;
      }});
  EXPECT_TRUE(both.met());
}

TEST_F(GraphTest, TwoFamiliesRunAtTheSameTime) {
  Meeting both(2);
  run(2, {.settle = [&](const JobRef& job) {
        if (job.row == mesh) {
          EXPECT_TRUE(both.join());
        }
        return true;
      }});
  EXPECT_TRUE(both.met());
}

// One thread, the caller's, cannot do two things at once. The meeting gives another thread, were there one,
// the time to show itself.
TEST_F(GraphTest, WithOneThreadEverythingRunsInTheCallersThread) {
  const auto caller = std::this_thread::get_id();
  Meeting somebody_else(2, std::chrono::milliseconds(200));
  run(2, {1, 2}, {.settle = [&](const JobRef& job) {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        if (job.row == scan) somebody_else.join();
        return true;
      }});
  EXPECT_FALSE(somebody_else.met());
}

TEST_F(GraphTest, ARowWithALimitRunsNoMoreOftenAtATime) {
  catalog.rows[scan_field].limit = 1;
  std::atomic<int> at_work = 0;
  run(5, {8, 9}, {.settle = [&](const JobRef& job) {
        if (job.row == scan_field) {
          EXPECT_EQ(++at_work, 1);
          std::this_thread::yield();
          --at_work;
        }
        return true;
      }});
  EXPECT_EQ(settled(scan_field), 5U * kViews);
}

// With one thread the order is that of the priorities: a family is finished before the next is begun.
TEST_F(GraphTest, LaterRowsGoFirst) {
  run(4, {1, 4}, {});
  std::vector<std::size_t> families;
  for (const JobRef& job : order)
    if (!job.item.is_set() && (families.empty() || families.back() != job.item.family))
      families.push_back(job.item.family);
  EXPECT_THAT(families, ElementsAre(0, 1, 2, 3));
}

TEST_F(GraphTest, AsManyFamiliesAreInsideAsThereAreTokensAndNoMore) {
  std::atomic<int> inside = 0, most = 0;
  Meeting first_three(3);
  run(100, {4, 3},
      {.enter =
           [&](std::size_t) {
             const int now = ++inside;
             int seen = most;
             while (now > seen && !most.compare_exchange_weak(seen, now)) {
             }
             return true;
           },
       .settle =
           [&](const JobRef& job) {
             if (job.row == mesh && job.item.family < 3) first_three.join();
             return true;
           },
       .leave = [&](std::size_t) { --inside; }});
  EXPECT_EQ(inside, 0);
  EXPECT_EQ(most, 3);
}

TEST_F(GraphTest, AFamilyThatCannotEnterKeepsItsJobsAndHoldsNobodyUp) {
  run(10, {2, 1}, {.enter = [](std::size_t family) { return family % 3 != 0; }});
  EXPECT_EQ(settled(second), 6U * kViews);
  EXPECT_EQ(settled(mean), 0U) << "its members are not all there";
}

TEST_F(GraphTest, ASetThatCannotBeSettledStaysOpen) {
  run(2, {.settle = [&](const JobRef& job) { return job.row != mean; }});
  EXPECT_EQ(settled(mean), 0U);
  EXPECT_EQ(settled(second), 2U * kViews);
}

TEST_F(GraphTest, StopLetsTheJobsAtWorkEndAndStartsNoOthers) {
  std::atomic<bool> stop = false;
  std::atomic<int> jobs = 0, entered = 0, left = 0;
  run(100, {2, 2},
      {.enter = [&](std::size_t) { return ++entered, true; },
       .settle =
           [&](const JobRef&) {
             if (++jobs == 100) stop = true;
             return true;
           },
       .leave = [&](std::size_t) { ++left; }},
      stop);
  EXPECT_GE(jobs, 100);
  EXPECT_LE(jobs, 101);  // the other thread's
  EXPECT_EQ(entered, left);
}

TEST_F(GraphTest, TheFirstExceptionComesOutAfterTheGraphHasRunDry) {
  std::atomic<int> entered = 0, left = 0;
  const GraphBodies bodies{.enter = [&](std::size_t) { return ++entered, true; },
                           .settle =
                               [&](const JobRef& job) {
                                 if (job.row == scan && job.item.family >= 5)
                                   throw std::runtime_error("disk full");
                                 return true;
                               },
                           .leave = [&](std::size_t) { ++left; }};
  EXPECT_THAT([&] { run(1000, {2, 1}, bodies); }, testing::ThrowsMessage<std::runtime_error>("disk full"));
  EXPECT_EQ(entered, left);
  EXPECT_EQ(entered, 6);
  EXPECT_EQ(settled(mesh), 6U);
}

TEST_F(GraphTest, NothingToDoIsFine) {
  run(0);
  EXPECT_THAT(order, ElementsAre(JobRef{mean, Item::set()}));
}

// --- as it is printed -------------------------------------------------------------------------------------

using Pair = std::pair<std::string, std::string>;

std::string node(const Row& row) { return row.name + " of " + std::string(name_of(row.shapes)); }

std::multiset<Pair> edges_in(const std::string& dot) {
  std::multiset<Pair> found;
  for (std::size_t at = dot.find("\" -> \""); at != std::string::npos; at = dot.find("\" -> \"", at + 1)) {
    const std::size_t begin = dot.rfind('"', at - 1) + 1, end = dot.find('"', at + 6);
    found.emplace(dot.substr(begin, at - begin), dot.substr(at + 6, end - at - 6));
  }
  return found;
}

TEST(GraphText, OfTheDefaultConfigurationItIsTheCatalogNodeForNodeAndEdgeForEdge) {
  const Catalog catalog = make_catalog(toy_config(""));
  const std::string dot = graph_dot(graph_of(catalog)), text = graph_text(graph_of(catalog));
  std::multiset<Pair> expected;
  for (const Row& row : catalog.rows) {
    EXPECT_THAT(dot, testing::HasSubstr("  \"" + node(row) + "\" ["));
    EXPECT_THAT("\n" + text, testing::HasSubstr("\n" + node(row) + " (version "));
    for (const std::size_t input : row.inputs) expected.emplace(node(catalog.rows[input]), node(row));
  }
  EXPECT_EQ(edges_in(dot), expected);
  // A few that the paper's figure has.
  EXPECT_THAT(edges_in(dot), IsSupersetOf({Pair("mesh of meshes", "scan of scans"),
                                           Pair("scan_normals of scans", "fpfh of scans"),
                                           Pair("fpfh of scans", "map.LS of scans"),
                                           Pair("reference of scans", "matched.LS of scans"),
                                           Pair("matched.LS of scans", "scores.LS of scans")}));
}

}  // namespace
}  // namespace salbench
