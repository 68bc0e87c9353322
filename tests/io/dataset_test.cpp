// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/dataset.h"

#include <fmt/format.h>

#include "io/shapes/text_scanner.h"
#include "tests/support/data.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

class DatasetFolder : public TemporaryFolder {
 public:
  DatasetFolder(std::initializer_list<const char*> files) {
    for (const char* file : files) write(file, "");
  }
};

Dataset found(const std::filesystem::path& root, const char* layout) {
  return native_dataset(data_folder(root), layout);
}

// "2 cup Meshes/22.off Distributions/22.val RawData/22_0.pid", paths relative to `base`.
std::vector<std::string> summary(const Dataset& dataset, const std::filesystem::path& base) {
  std::vector<std::string> lines;
  for (const Item& item : dataset.items) {
    std::string line = item.name + " " + (item.category.empty() ? "-" : item.category);
    const auto add = [&](const std::filesystem::path& path) {
      line += " " + path.lexically_relative(base).string();
    };
    add(item.file);
    if (!item.saliency.empty()) add(item.saliency);
    for (const auto& path : item.picks) add(path);
    lines.push_back(line);
  }
  return lines;
}

void expect_refusal(const std::filesystem::path& root, const char* layout,
                    const testing::Matcher<std::string>& why) {
  EXPECT_THAT([&] { found(root, layout); }, ThrowsMessage<InputError>(why));
}

TEST(Dataset, FindsTheSchellingLayoutFromAnyOfItsFolders) {
  const DatasetFolder folder = {
      "SchellingData/SchellingData/Meshes/21.off",        "SchellingData/SchellingData/Meshes/3.off",
      "SchellingData/SchellingData/Distributions/21.val", "SchellingData/SchellingData/RawData/21_0.pid",
      "SchellingData/SchellingData/RawData/21_10.pid",    "SchellingData/SchellingData/RawData/21_9.pid"};
  const auto inner = folder / "SchellingData" / "SchellingData";
  for (const auto& root : {folder.path(), folder / "SchellingData", inner, folder / "SchellingData/"}) {
    SCOPED_TRACE(root);
    EXPECT_THAT(summary(found(root, "schelling"), inner),
                ElementsAre("3 human Meshes/3.off",
                            "21 cup Meshes/21.off Distributions/21.val RawData/21_0.pid "
                            "RawData/21_9.pid RawData/21_10.pid"));
  }
}

TEST(Dataset, NamesMayHaveDigitsAndUnderscores) {
  const DatasetFolder folder = {"Meshes/michael3.off", "Meshes/michael.off",     "Meshes/a_1.off",
                                "Meshes/a.off",        "RawData/michael3_0.pid", "RawData/michael_30.pid",
                                "RawData/a_1.pid",     "RawData/a_1_2.pid"};
  EXPECT_THAT(summary(found(folder.path(), "schelling"), folder.path()),
              ElementsAre("a - Meshes/a.off RawData/a_1.pid", "a_1 - Meshes/a_1.off RawData/a_1_2.pid",
                          "michael - Meshes/michael.off RawData/michael_30.pid",
                          "michael3 - Meshes/michael3.off RawData/michael3_0.pid"));
}

TEST(Dataset, TakesAnyFolderOfMeshes) {
  const DatasetFolder folder = {
      "all/10.off",      "all/2.OBJ",      "all/horse.ply",           "all/readme.txt",
      "all/.hidden.off", "all/more/4.off", "Distributions/horse.val", "RawData/2_0.pid"};
  const Dataset dataset = found(folder / "all", "folder");
  EXPECT_THAT(summary(dataset, folder.path()), ElementsAre("2 - all/2.OBJ RawData/2_0.pid", "10 - all/10.off",
                                                           "horse - all/horse.ply Distributions/horse.val"));
  EXPECT_THAT(dataset.notes, IsEmpty());
}

TEST(Dataset, HasClassesIfAllMeshesAreNumbersOfTheBenchmark) {
  const DatasetFolder folder = {"Meshes/1.off", "Meshes/20.off", "Meshes/261.off", "Meshes/400.off"};
  EXPECT_THAT(summary(found(folder.path(), "schelling"), folder.path()),
              ElementsAre("1 human Meshes/1.off", "20 human Meshes/20.off", "261 spring Meshes/261.off",
                          "400 four-legged Meshes/400.off"));
  for (const char* other : {"0", "401", "007", "1b"}) {
    const TemporaryFolder mixed;
    for (const std::string name : {"1", other}) mixed.write("Meshes/" + name + ".off", "");
    const Dataset dataset = found(mixed.path(), "schelling");
    for (const Item& item : dataset.items) EXPECT_EQ(item.category, "") << other;
    EXPECT_THAT(dataset.notes, IsEmpty());
  }
}

TEST(Dataset, NotesGroundTruthWithoutAMesh) {
  DatasetFolder folder = {"Meshes/horse.off",  "Distributions/261.val", "RawData/261_0.pid",
                          "RawData/261_1.pid", "RawData/cow_0.pid",     "RawData/readme.pid",
                          "RawData/notes.txt"};
  EXPECT_THAT(found(folder.path(), "schelling").notes,
              ElementsAre(HasSubstr("readme.pid: is not named NAME_NUMBER.pid"),
                          HasSubstr("without a mesh or point cloud: 261, cow")));
  for (int i = 1; i <= 12; ++i) folder.write(fmt::format("Distributions/{}.val", i), "");
  EXPECT_THAT(found(folder.path(), "schelling").notes,
              Contains(HasSubstr(": 1, 2, 3, 4, 5, 6, 7, 8 and 6 others")));
}

TEST(Dataset, NotesMeshesThatTheBenchmarkHasAndTheFolderHasNot) {
  const TemporaryFolder folder;
  for (int i = 1; i <= 400; ++i)
    if ((i < 261 || i > 280) && i != 399) folder.write("Meshes/" + std::to_string(i) + ".off", "");
  EXPECT_THAT(
      found(folder.path(), "schelling").notes,
      ElementsAre(AllOf(StartsWith("379 of the 400 meshes of SHREC'07 are here, without 261-280, 399; "),
                        HasSubstr((folder / "Meshes").string()))));
}

TEST(Dataset, ExtensionsMayBeInUpperOrLowerCase) {
  const DatasetFolder folder = {"Meshes/1.OFF",        "Meshes/2.off",    "Distributions/1.VAL",
                                "Distributions/2.val", "RawData/1_0.PID", "RawData/1_1.pid",
                                "RawData/readme.Pid"};
  const Dataset dataset = found(folder.path(), "schelling");
  EXPECT_THAT(summary(dataset, folder.path()),
              ElementsAre("1 human Meshes/1.OFF Distributions/1.VAL RawData/1_0.PID RawData/1_1.pid",
                          "2 human Meshes/2.off Distributions/2.val"));
  EXPECT_THAT(dataset.notes, Contains(HasSubstr("readme.Pid: is not named NAME_NUMBER.pid")));
}

TEST(Dataset, NotesThatTheFolderAboveHasClasses) {
  const DatasetFolder folder = {"Meshes/1.off", "Distributions/1.val", "other/1.off"};
  EXPECT_THAT(found(folder / "Meshes", "folder").notes, ElementsAre(HasSubstr("without classes")));
  EXPECT_THAT(found(folder / "other", "folder").notes, IsEmpty());
}

TEST(Dataset, TwoFilesOfOneNameAreAnError) {
  for (const std::vector<const char*>& files : {std::vector{"a.off", "a.ply", "b.off"},
                                                {"a.ply", "a.PLY"},
                                                {"Distributions/a.val", "Distributions/a.VAL", "a.off"},
                                                {"RawData/a_0.pid", "RawData/a_0.PID", "a.off"}}) {
    const TemporaryFolder folder;
    for (const char* file : files) folder.write(file, "");
    expect_refusal(folder.path(), "folder", AllOf(HasSubstr(files[0]), HasSubstr("the same name")));
  }
}

TEST(Dataset, SaysWhatItLookedForAndWhere) {
  const DatasetFolder folder = {"Meshes/readme.txt"};
  expect_refusal(folder.path(), "schelling",
                 AllOf(HasSubstr("no .off, .obj or .ply meshes found"),
                       HasSubstr("looked in schelling: " + (folder / "Meshes").string())));
  expect_refusal(folder / "absent", "folder", HasSubstr("absent: there is no such folder"));
  expect_refusal(folder / "Meshes/readme.txt", "folder", HasSubstr("is a file"));
}

TEST(Dataset, FindsTheRealData) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  const Dataset study = found(*data, "schelling");
  EXPECT_EQ(study.items.size(), 380U);
  EXPECT_EQ(std::count_if(study.items.begin(), study.items.end(),
                          [](const Item& item) { return item.picks.size() >= 22; }),
            19);
  EXPECT_THAT(study.notes,
              ElementsAre(StartsWith("380 of the 400 meshes of SHREC'07 are here, without 261-280; ")));

  const Dataset tracked = found(*data / "eyetracking", "schelling");
  EXPECT_EQ(tracked.items.size(), 23U);
  for (const Item& item : tracked.items) {
    EXPECT_EQ(item.category, "");
    EXPECT_FALSE(item.saliency.empty());
    EXPECT_EQ(item.picks.size(), 1U) << item.name;
  }
  EXPECT_THAT(tracked.notes, IsEmpty());
}

TEST(NaturalLess, ComparesRunsOfDigitsAsNumbers) {
  std::vector<std::string> names = {
      "10", "b2", "2", "a", "b10", "b010", "a_1_2", "a_1", "99999999999999999999999", "1b", "b", "02"};
  std::ranges::sort(names, natural_less);
  EXPECT_THAT(names, ElementsAre("1b", "02", "2", "10", "99999999999999999999999", "a", "a_1", "a_1_2", "b",
                                 "b2", "b010", "b10"));
}

TEST(NaturalLess, IsAStrictTotalOrder) {
  const std::vector<std::string> names = {"",    "0",   "00",   "1",   "01",   "1a", "01a", "a1",
                                          "a01", "a1b", "a01b", "1a2", "1a02", "_",  "1_"};
  for (const auto& a : names) {
    EXPECT_FALSE(natural_less(a, a));
    for (const auto& b : names) {
      EXPECT_EQ(natural_less(a, b) || natural_less(b, a), a != b) << a << " " << b;
      EXPECT_FALSE(natural_less(a, b) && natural_less(b, a)) << a << " " << b;
      for (const auto& c : names)
        EXPECT_TRUE(!natural_less(a, b) || !natural_less(b, c) || natural_less(a, c))
            << a << " " << b << " " << c;
    }
  }
}

}  // namespace
}  // namespace salbench
