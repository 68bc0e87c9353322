// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures: `salbench export` hands them on, and takes them first with --pictures.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "tests/e2e/workspace.h"
#include "tests/support/exported_file.h"
#include "tests/support/job_counts.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

const std::string kSmallPictures = std::string(kToyConfig) + "picture: {size: 40}\n";

std::vector<std::string> arrays_of_export(const Workspace& toy,
                                          const std::vector<std::string>& further = {}) {
  std::vector<std::string> words = {"--to", (toy / "toy.h5").string()};
  words.insert(words.end(), further.begin(), further.end());
  const Outcome ended = toy.salbench("export", words);
  EXPECT_EQ(ended.status, 0) << ended.err;
  return ExportedFile(toy / "toy.h5").arrays();
}

// Names without the checksum, which is also of the seconds that it took.
std::vector<std::string> contents(const Workspace& toy) {
  std::vector<std::string> names;
  for (const fs::path& file : toy.artefacts("picture")) {
    const std::string name = file.filename().string();
    names.push_back(name.substr(0, name.find('.', name.find('.', name.find('.') + 1) + 1)));
  }
  return names;
}

TEST(Pictures, AreTakenOnceAndEveryExportContainsThem) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_THAT(toy.artefacts("picture"), IsEmpty());
  EXPECT_THAT(arrays_of_export(toy), Not(Contains(HasSubstr("picture"))));
  arrays_of_export(toy, {"--pictures", "--items", "2"});
  EXPECT_THAT(toy.artefacts("picture"), SizeIs(13));
  EXPECT_THAT(toy.salbench("plan").out, testing::ContainsRegex("\npicture +0 +0 +0 +0 +0 +13 "));
  const auto arrays = arrays_of_export(toy);
  EXPECT_EQ(std::count_if(arrays.begin(), arrays.end(),
                          [](const std::string& name) { return name.ends_with("/picture/primitive"); }),
            13);
  const ExportedFile file(toy / "toy.h5");
  EXPECT_EQ(file.read("2/picture/primitive").shape, (std::vector<std::size_t>{400, 400}));
  EXPECT_EQ(file.read("2_5/picture/weights").shape, (std::vector<std::size_t>{400, 400, 3}));
  EXPECT_EQ(file.read("2_5/picture/view_projection").count(), 16U);
}

TEST(Pictures, AConfigurationThatHasThemComputesThemInEveryRunAndExport) {
  const Workspace toy(kSmallPictures);
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_THAT(toy.artefacts("picture"), SizeIs(26));
  const std::string with = toy.results();
  EXPECT_THAT(arrays_of_export(toy, {"--stage", "picture", "--items", "1"}), SizeIs(13 * 6));
  toy.configure(kToyConfig);
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.results(), with);
  EXPECT_EQ(toy.computed(), 0U);
}

TEST(Pictures, TheSameBytesWithAnyNumberOfThreads) {
  std::vector<std::string> first;
  for (const char* threads : {"1", "2", "4"}) {
    const Workspace toy(kSmallPictures);
    ASSERT_EQ(toy.salbench("run", {"--threads", threads}).status, 0);
    const auto now = contents(toy);
    ASSERT_THAT(now, SizeIs(26));
    if (first.empty()) first = now;
    EXPECT_EQ(now, first) << threads;
  }
}

TEST(Pictures, AMeshThatCannotBeSeenIsNamedAndTheOthersGoOn) {
  const Workspace toy(kSmallPictures);
  toy.write("data set/Meshes/3.off", "OFF\n3 1 0\n0 0 0\n1 1 1\n2 2 2\n3 0 1 2\n");
  const Outcome ended = toy.salbench("export", {"--to", (toy / "toy.h5").string(), "--pictures"});
  EXPECT_EQ(ended.status, 1) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("3: "));
  EXPECT_THAT(toy.artefacts("picture"), SizeIs(26));
}

// --- what a report reads of a run
// ---------------------------------------------------------------------------

TEST(RunRecord, TellsMemoryCacheAndTimeline) {
  const Workspace toy(kMeshesOnly);
  const Outcome ended = toy.salbench("run");
  ASSERT_EQ(ended.status, 0);
  EXPECT_THAT(ended.out,
              testing::EndsWith("to make a report of them: salbench report " + toy.out().string() + "\n"));
  const Section record = Section::from_file((toy.out() / "run.yaml").string());
  EXPECT_GT(std::stod(record.text("peak_memory_mb").value_or("0")), 5);
  std::uintmax_t bytes = 0;
  for (const fs::path& file : toy.artefacts("fpfh")) bytes += fs::file_size(file);
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
