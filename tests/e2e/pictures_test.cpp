// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures: `salbench export` hands them on, and takes them first with --pictures.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cache/recipes.h"
#include "io/table.h"
#include "pipeline/config/section.h"
#include "tests/e2e/workspace.h"
#include "tests/support/cache_files.h"
#include "tests/support/exported_file.h"
#include "tests/support/text_column.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

std::vector<std::string> arrays_of_export(const Workspace& toy,
                                          const std::vector<std::string>& further = {}) {
  std::vector<std::string> words = {"--to", (toy / "toy.h5").string()};
  words.insert(words.end(), further.begin(), further.end());
  const Outcome ended = toy.salbench("export", words);
  EXPECT_EQ(ended.status, 0) << ended.err;
  return ExportedFile(toy / "toy.h5").arrays();
}

TEST(Pictures, AreTakenOnceAndEveryExportContainsThem) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_THAT(toy.artefacts("picture"), IsEmpty());
  EXPECT_THAT(arrays_of_export(toy), Not(Contains(HasSubstr("picture"))));
  arrays_of_export(toy, {"--pictures", "--items", "2"});
  EXPECT_THAT(toy.artefacts("picture"), SizeIs(13));
  EXPECT_THAT(toy.salbench("plan", {"--all"}).out, testing::ContainsRegex("\npicture +0 +0 +0 +0 +0 +13 "));
  const auto arrays = arrays_of_export(toy);
  EXPECT_EQ(std::count_if(arrays.begin(), arrays.end(),
                          [](const std::string& name) { return name.ends_with("/picture/primitive"); }),
            13);
  const ExportedFile file(toy / "toy.h5");
  EXPECT_EQ(file.read("2/picture/primitive").shape, (std::vector<std::size_t>{400, 400}));
  EXPECT_EQ(file.read("2_5/picture/weights").shape, (std::vector<std::size_t>{400, 400, 3}));
  EXPECT_EQ(file.read("2_5/picture/view_projection").count(), 16U);
}

// --- what a report reads of a run --------------------------------------------------------------------------

TEST(RunRecord, TellsMemoryCacheAndTimeline) {
  const Workspace toy(kMeshesOnly);
  const Outcome ended = toy.salbench("run");
  ASSERT_EQ(ended.status, 0);
  EXPECT_THAT(ended.out,
              testing::EndsWith("to make a report of them: salbench report " + toy.out().string() + "\n"));
  const Section record = Section::from_file((toy.out() / "run.yaml").string());
  EXPECT_GT(std::stod(record.text("peak_memory_mb").value_or("0")), 5);
  std::uintmax_t bytes = 0;
  for (const KnownArtefact& known : artefacts_of(toy.cache()))
    if (known.stage == "fpfh") bytes += bytes_of(*read_artefact(known));
  EXPECT_EQ(record.child("cache_bytes").text("fpfh"), std::to_string(bytes));
  const Table timeline = read_csv(toy.out() / "timeline.csv");
  EXPECT_THAT(timeline.columns, testing::ElementsAre("start", "end", "node", "busy"));
  EXPECT_THAT(text_column(timeline, "node"), AllOf(Contains("mesh of meshes"), Contains("map.PS of meshes")));
  // Run again, nothing was at work, and the artefacts are still those of the run.
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_THAT(read_csv(toy.out() / "timeline.csv").rows, IsEmpty());
  EXPECT_EQ(Section::from_file((toy.out() / "run.yaml").string()).child("cache_bytes").text("fpfh"),
            std::to_string(bytes));
  EXPECT_THAT(toy.salbench("run", {"--quiet"}).out, IsEmpty());
}

}  // namespace
}  // namespace salbench
