// SPDX-License-Identifier: GPL-3.0-or-later
// Why something is computed is said before, by plan and explain, and afterwards, by run.yaml.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "tests/e2e/workspace.h"

namespace salbench {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TEST(Explain, ThePlanTheExplanationAndTheRecordAgree) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run").status, 0);
  toy.configure("dataset: {scans: false}\nmodels: {PS: {absolute: true}, RS: }\n");
  const auto before = toy.contents();
  EXPECT_THAT(lines_with(toy.salbench("plan").out, "map.PS "),
              ElementsAre(HasSubstr("models.PS.absolute false -> true: 2")));
  const Outcome all = toy.salbench("explain", {"2"});
  EXPECT_EQ(all.status, 0);
  EXPECT_THAT(lines_with(all.out, "scores.PS"),
              ElementsAre(HasSubstr("waits for matched.PS, waits for map.PS: ")));
  const Outcome one = toy.salbench("explain", {"2", "map.PS"});
  EXPECT_THAT(one.out, AllOf(HasSubstr("models.PS.absolute false -> true"), HasSubstr("nearest: "),
                             Not(HasSubstr("matched.PS"))));
  EXPECT_EQ(toy.contents(), before);

  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string record = read_file(toy.out() / "run.yaml");
  EXPECT_THAT(lines_with(record, " map.PS: {"),
              ElementsAre(HasSubstr("why: {\"models.PS.absolute false -> true\": 2}}")));
  EXPECT_THAT(lines_with(record, " matched.PS: {"),
              ElementsAre(HasSubstr("why: {\"input map.PS changed\": 2}}")));
  EXPECT_THAT(lines_with(record, " map.RS: {"), ElementsAre(HasSubstr("why: {}}")));
}

}  // namespace
}  // namespace salbench
