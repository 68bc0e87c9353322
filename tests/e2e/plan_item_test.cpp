// SPDX-License-Identifier: GPL-3.0-or-later
// The plan of one item says why something will be computed, and which lines of the recipe differ from those
// in the cache.
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

TEST(PlanItem, ShowsTheRecipeBesideThoseInTheCache) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_THAT(toy.salbench("plan", {"2"}).out, Not(HasSubstr("to compute")));
  toy.configure("dataset: {scans: false}\nmodels: {PS: {absolute: true}, RS: }\n");
  const auto before = toy.contents();
  const Outcome all = toy.salbench("plan", {"2"});
  EXPECT_EQ(all.status, 0);
  EXPECT_THAT(lines_with(all.out, "map.PS "), ElementsAre(HasSubstr("to compute")));
  EXPECT_THAT(lines_with(all.out, "map.RS "), ElementsAre(HasSubstr("cached")));
  const Outcome one = toy.salbench("plan", {"2", "map.PS"});
  EXPECT_THAT(one.out, AllOf(HasSubstr("\n  - absolute: false\n"), HasSubstr("\n  + absolute: true\n"),
                             Not(HasSubstr("matched.PS"))));
  EXPECT_EQ(toy.contents(), before);
  EXPECT_EQ(toy.salbench("plan", {"2", "map.MISSING"}).status, 2);
  EXPECT_EQ(toy.salbench("plan", {"3000"}).status, 2);
  EXPECT_EQ(toy.salbench("plan", {"2", "--format", "dot"}).status, 2) << "which is the form of a graph";
}

}  // namespace
}  // namespace salbench
