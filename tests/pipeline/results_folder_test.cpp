// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run/results_folder.h"

#include "io/file.h"
#include "pipeline/config/section.h"
#include "pipeline/results/tables.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

constexpr const char* kNow = "program: salbench 2\n";

TEST(ResultsFolder, TablesAndRecordsOfNoRunAreNotReplaced) {
  std::vector<std::string> names = names_of_tables();
  names.insert(names.end(), files_of_conclusions().begin(), files_of_conclusions().end());
  for (const std::string& name : names) {
    const TemporaryFolder folder;
    folder.write(name, "years of work");
    EXPECT_THAT([&] { begin_results(folder.path(), kNow); },
                Refuses<ConfigError>("has " + name + ", and no run.yaml, so it is of no run"));
  }
  for (const char* configuration :
       {"", "models: {RS: }\n", "# of mine\nprogram: mine\n", "# program: salbench"}) {
    const TemporaryFolder folder;
    folder.write("run.yaml", configuration);
    EXPECT_THAT([&] { begin_results(folder.path(), kNow); },
                Refuses<ConfigError>("run.yaml: is no record of a run"));
  }
}

TEST(ResultsFolder, ThatOfAnEarlierRunIsTaken) {
  const std::string under_way(kUnderWay);
  for (const std::string& record : {under_way, under_way + "program: salbench 1.1.0\n",
                                    std::string("# SIMULATED\n# of gaze\nprogram: salbench 1.0.0\n")}) {
    const TemporaryFolder folder;
    folder.write("run.yaml", record);
    folder.write("results.csv", "item\n");
    folder.write("notes.txt", "of mine");
    begin_results(folder.path(), kNow);
    EXPECT_EQ(read_file(folder / "run.yaml"), kNow);
    EXPECT_EQ(read_file(folder / "notes.txt"), "of mine");
  }
}

}  // namespace
}  // namespace salbench
