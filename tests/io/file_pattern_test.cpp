// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/file_pattern.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// "michael_1/front.txt: michael_1, front" of each file that fits, then "- readme.txt" of those left out.
std::vector<std::string> found(const TemporaryFolder& folder, const std::string& pattern,
                               const std::set<std::string, std::less<>>& items = {}) {
  std::vector<std::string> lines;
  const FoundFiles files =
      files_like(folder.path(), {pattern}, [&](std::string_view name) { return items.contains(name); });
  for (const FoundFile& file : files.fit)
    lines.push_back(file.path.lexically_relative(folder.path()).string() + ": " + file.item + ", " +
                    file.part);
  for (const auto& path : files.left_out)
    lines.push_back("- " + path.lexically_relative(folder.path()).string());
  return lines;
}

void write_all(const TemporaryFolder& folder, std::initializer_list<const char*> files) {
  for (const char* file : files) folder.write(file, "");
}

TEST(FilePattern, TakesTheFilesOfAFolderInNaturalOrder) {
  const TemporaryFolder folder;
  write_all(folder, {"off/10.off", "off/2.off", "off/.hidden.off", "off/2.obj", "off/below/3.off", "1.off"});
  EXPECT_THAT(found(folder, "off/*.off"), ElementsAre("off/2.off: , ", "off/10.off: , "));
  EXPECT_THAT(found(folder, "off/*"), ElementsAre("off/2.obj: , ", "off/2.off: , ", "off/10.off: , "));
  EXPECT_THAT(found(folder, "*/*/*.off"), ElementsAre("off/below/3.off: , "));
  EXPECT_THAT(found(folder, "absent/*"), IsEmpty());
  EXPECT_THAT(found(folder, "off/../1.off"), ElementsAre("1.off: , "));
}

TEST(FilePattern, ReadsTheLongestItemThatThereIs) {
  const TemporaryFolder folder;
  write_all(folder, {"a_1.pid", "a_1_2.pid", "a_1_2_3.pid", "b_7.pid", "b_x.pid", "b_7.txt"});
  EXPECT_THAT(found(folder, "{item}_{participant}.pid", {"a", "a_1"}),
              ElementsAre("a_1.pid: a, 1", "a_1_2.pid: a_1, 2", "a_1_2_3.pid: a_1_2, 3", "b_7.pid: b, 7",
                          "- b_x.pid"));
}

TEST(FilePattern, AViewIsAnyText) {
  const TemporaryFolder folder;
  write_all(folder, {"cat_front_left.txt", "cat_2.txt", "cat_front_left_x.txt", "dog.txt"});
  EXPECT_THAT(found(folder, "{item}_{view}.txt", {"cat", "cat_front"}),
              ElementsAre("cat_2.txt: cat, 2", "cat_front_left.txt: cat_front, left",
                          "cat_front_left_x.txt: cat_front, left_x", "- dog.txt"));
}

TEST(FilePattern, AnItemMayBeAFolder) {
  const TemporaryFolder folder;
  write_all(folder, {"cat/cat_1.csv", "cat/dog_1.csv", "dog/dog_1.csv", "maps_a/cat.txt", "maps_b/dog.txt"});
  EXPECT_THAT(found(folder, "{item}/{item}_{viewer}.csv", {"cat", "dog"}),
              ElementsAre("cat/cat_1.csv: cat, 1", "dog/dog_1.csv: dog, 1", "- cat/dog_1.csv"));
  EXPECT_THAT(found(folder, "maps_*/{item}.txt", {"cat", "dog"}),
              ElementsAre("maps_a/cat.txt: cat, ", "maps_b/dog.txt: dog, "));
}

TEST(FilePattern, KnowsWhetherThereIsAFolderForIt) {
  const TemporaryFolder folder;
  write_all(folder, {"maps_a/cat.txt", "file"});
  for (const char* there : {"maps_a/{item}.txt", "maps_*/{item}.txt", "{item}.txt"})
    EXPECT_TRUE(has_folder_for(folder.path(), {there})) << there;
  for (const char* absent : {"maps/{item}.txt", "dataset_*/{item}.txt", "file/{item}.txt", ""})
    EXPECT_FALSE(has_folder_for(folder.path(), {absent})) << absent;
}

TEST(FilePattern, SaysWhatIsWrong) {
  for (const char* good : {"*", "off/*.off", "../off/*", "a/*/*.obj", "one.off"})
    EXPECT_EQ(wrong_with_mesh_pattern(good), "") << good;
  EXPECT_THAT(wrong_with_mesh_pattern(""), HasSubstr("is empty"));
  EXPECT_THAT(wrong_with_mesh_pattern("/off/*"), HasSubstr("must be relative"));
  EXPECT_THAT(wrong_with_mesh_pattern("off//*"), HasSubstr("must be relative"));
  EXPECT_THAT(wrong_with_mesh_pattern("off/{item}.off"), HasSubstr("must have * where"));
  EXPECT_THAT(wrong_with_mesh_pattern("*a*b*c*"), HasSubstr("more than 3 placeholders"));
  const std::vector<std::string_view> views = {"{view}", "{viewer}"};
  EXPECT_EQ(wrong_with_truth_pattern("a/{item}_{view}.txt", views), "");
  EXPECT_THAT(wrong_with_truth_pattern("a/*.txt", views), HasSubstr("must have {item}"));
  EXPECT_THAT(wrong_with_truth_pattern("a/{itm}.txt", views), HasSubstr("braces around something other"));
  EXPECT_THAT(wrong_with_truth_pattern("a/{item}}.txt", views), HasSubstr("braces around something other"));
  EXPECT_THAT(wrong_with_truth_pattern("{item}_{participant}.pid", views),
              HasSubstr("cannot have {participant} here"));
  EXPECT_THAT(wrong_with_truth_pattern("{item}_{view}_{viewer}", views), HasSubstr("both"));
}

TEST(FilePattern, NamesWhatIsExpected) {
  EXPECT_EQ(expected_name({"RawData/{item}_{participant}.pid"}), "NAME_NUMBER.pid");
  EXPECT_EQ(expected_name({"a/{item}_{view}*.txt"}), "NAME_VIEW*.txt");
  EXPECT_EQ(place_of("/data", {"off/*"}), "/data/off");
  EXPECT_EQ(place_of("/data", {"../off/*.off"}), "/off/*.off");
}

}  // namespace
}  // namespace salbench
