// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/results/record.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

using std::chrono::milliseconds;

double number(const Cell& cell) { return std::get<double>(cell); }

TEST(Timeline, SharesTheTimeOfEachJobAmongTheIntervalsItLasts) {
  const Rules rules = make_rules(toy_config());
  const auto began = Clock::now();
  std::vector<RuleRecord> records(rules.size());
  const std::size_t mesh = find_rule(rules, kMeshes, "mesh"), scan = find_rule(rules, kScans, "scan");
  records[mesh] = {.seconds = {0.25F, 1},
                   .started = {began + milliseconds(500), began + milliseconds(23'000)}};
  records[scan] = {.seconds = {3, 3}, .started = {began, began + milliseconds(1000)}};  // two cores
  const Table table = timeline_table(rules, records, began, 24);
  EXPECT_THAT(table.columns, testing::ElementsAre("start", "end", "node", "busy"));
  std::map<std::string, double> sums;
  for (const auto& row : table.rows) {
    EXPECT_NEAR(number(row[1]) - number(row[0]), 0.1, 1e-5);
    EXPECT_GT(number(row[3]), 0);
    EXPECT_LE(number(row[3]), 0.2 + 1e-5);
    sums[std::get<std::string>(row[2])] += number(row[3]);
    const bool both_cores = number(row[0]) > 1.01 && number(row[1]) < 2.99;
    if (both_cores) {
      EXPECT_NEAR(number(row[3]), 0.2, 1e-5) << number(row[0]);
    }
  }
  EXPECT_NEAR(sums["mesh of meshes"], 1.25, 1e-4);
  EXPECT_NEAR(sums["scan of scans"], 6, 1e-4);
  EXPECT_THAT(table.rows, testing::SizeIs(3 + 10 + 40));  // 0.5-0.75 s, 23-24 s; 0-4 s
}

TEST(Timeline, OfNothingIsEmpty) {
  const Rules rules = make_rules(toy_config());
  const std::vector<RuleRecord> records(rules.size());
  EXPECT_THAT(timeline_table(rules, records, Clock::now(), 0).rows, testing::IsEmpty());
  EXPECT_THAT(timeline_table(rules, records, Clock::now(), 5).rows, testing::IsEmpty());
}

}  // namespace
}  // namespace salbench
