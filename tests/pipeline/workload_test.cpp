// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/plan/workload.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Dataset numbered(const TemporaryFolder& folder) {
  Dataset dataset;
  for (const char* name : {"1", "2", "5", "10", "cow"})
    dataset.items.push_back({name, "", folder.write(std::string(name) + ".off", name), {}, {}});
  return dataset;
}

std::vector<std::string> names(const Workload& workload) {
  std::vector<std::string> result;
  for (const Family& family : workload.families) result.push_back(family.source.name);
  return result;
}

TEST(Workload, SelectsNamesAndRangesInTheDataSetsOrder) {
  const TemporaryFolder folder;
  const Dataset dataset = numbered(folder);
  EXPECT_THAT(names(make_workload(dataset, "")), ElementsAre("1", "2", "5", "10", "cow"));
  EXPECT_THAT(names(make_workload(dataset, "cow, 2-9")), ElementsAre("2", "5", "cow"));
  EXPECT_THAT(names(make_workload(dataset, "10,1")), ElementsAre("1", "10"));
}

TEST(Workload, NamesWhatASelectionDoesNotFind) {
  const TemporaryFolder folder;
  const Dataset dataset = numbered(folder);
  for (const char* bad : {"3", "20-30", "9-2", "horse", "1-x", ","})
    EXPECT_THROW(make_workload(dataset, bad), ConfigError) << bad;
}

TEST(Workload, DigestsContentNotPaths) {
  const TemporaryFolder a, b;
  const Workload first = make_workload(numbered(a), ""), second = make_workload(numbered(b), "");
  EXPECT_EQ(first.families[0].shape_file[0].digest, second.families[0].shape_file[0].digest);
  EXPECT_NE(first.families[0].shape_file[0].digest, first.families[1].shape_file[0].digest);
}

TEST(Workload, AnUnreadableFileIsKeptForItsItem) {
  Dataset dataset;
  dataset.items.push_back({"gone", "", "/no/such/mesh.off", {}, {}});
  const Workload workload = make_workload(dataset, "");
  EXPECT_FALSE(workload.families[0].shape_file[0].digest);
  EXPECT_THAT(workload.families[0].shape_file[0].error, HasSubstr("/no/such/mesh.off"));
}

}  // namespace
}  // namespace salbench
