// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/recipes.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cache/folder_store.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;
using testing::UnorderedElementsAre;
using Part = RecipeDifference::Part;

const Digest kOne{0, 1}, kTwo{0, 2};

Recipe recipe() {
  return {"fpfh", 3, "radius: 0.02\ngrow: true\n", "1/52", {{"mesh", kOne}, {"normals", kOne}}};
}

TEST(RecipeDifferences, EqualRecipesHaveNone) { EXPECT_THAT(differences(recipe(), recipe()), IsEmpty()); }

TEST(RecipeDifferences, EachComponentIsNamedWithBothSides) {
  Recipe now = recipe();
  now.stage_version = 4;
  EXPECT_THAT(differences(recipe(), now), ElementsAre(RecipeDifference{Part::version, "", "3", "4"}));
  now = recipe();
  now.options = "radius: 0.03\ngrow: true\n";
  EXPECT_THAT(differences(recipe(), now),
              ElementsAre(RecipeDifference{Part::option, "radius", "0.02", "0.03"}));
  now = recipe();
  now.seed = "2/52";
  EXPECT_THAT(differences(recipe(), now), ElementsAre(RecipeDifference{Part::seed, "", "1/52", "2/52"}));
  now = recipe();
  now.inputs[1].second = kTwo;
  EXPECT_THAT(differences(recipe(), now),
              ElementsAre(RecipeDifference{Part::input, "normals", kOne.hex(), kTwo.hex()}));
}

TEST(RecipeDifferences, WhatOneSideLacksIsEmptyThere) {
  Recipe now = recipe();
  now.options = "radius: 0.02\nneighbours: 9\n";
  now.inputs = {{"mesh", kOne}, {"picks 3", kTwo}};
  EXPECT_THAT(differences(recipe(), now),
              UnorderedElementsAre(RecipeDifference{Part::option, "grow", "true", ""},
                                   RecipeDifference{Part::option, "neighbours", "", "9"},
                                   RecipeDifference{Part::input, "normals", kOne.hex(), ""},
                                   RecipeDifference{Part::input, "picks 3", "", kTwo.hex()}));
}

// Whatever changes the key is a difference.
TEST(RecipeDifferences, AnotherOrderIsADifferenceToo) {
  Recipe now = recipe();
  std::swap(now.inputs[0], now.inputs[1]);
  ASSERT_NE(key_of(now), key_of(recipe()));
  EXPECT_THAT(differences(recipe(), now), ElementsAre(RecipeDifference{Part::order, "", "", ""}));
  now = recipe();
  now.options = "grow: true\nradius: 0.02\n";
  EXPECT_THAT(differences(recipe(), now), ElementsAre(RecipeDifference{Part::order, "", "", ""}));
}

class RecipeBookTest : public testing::Test {
 protected:
  void save(const std::string& item, const Recipe& what = recipe()) const {
    FolderStore(folder_.path(), Access::read_write)
        .save(what, "field", {{"saliency", {1}, std::vector<double>{1}, "1", "one value"}}, {item, 0.5, {}});
  }
  TemporaryFolder folder_;
};

TEST_F(RecipeBookTest, ReadsBackWhatWasSaved) {
  save("a/b");  // in the file's name: a_b
  RecipeBook book(folder_.path());
  ASSERT_THAT(book.artefacts("fpfh", "a/b"), SizeIs(1));
  const auto reading = read_recipe(book.artefacts("fpfh", "a/b").front());
  ASSERT_TRUE(reading.recipe);
  EXPECT_EQ(key_of(*reading.recipe), key_of(recipe()));
  EXPECT_THAT(reading.fault, IsEmpty());
}

TEST_F(RecipeBookTest, TellsStagesAndItemsApart) {
  save("52");
  save("53");
  RecipeBook book(folder_.path());
  EXPECT_THAT(book.artefacts("fpfh", "52"), SizeIs(1));
  EXPECT_THAT(book.artefacts("fpfh", "5"), IsEmpty());
  EXPECT_THAT(book.artefacts("normals", "52"), IsEmpty());
  EXPECT_THAT(RecipeBook(folder_ / "not-there").artefacts("fpfh", "52"), IsEmpty());
}

TEST_F(RecipeBookTest, FindsItemsInAnyOrderOfStages) {
  Recipe map = recipe();
  map.stage = "map.PS";
  for (const char* item : {"5", "52", "52_3"}) {
    save(item);
    save(item, map);
  }
  Recipe other = recipe();
  other.seed = "2/52";
  save("52", other);
  RecipeBook book(folder_.path());
  for (const char* item : {"52", "52", "5", "52_3", "52"})
    for (const char* stage : {"fpfh", "map.PS"}) {
      const auto found = book.artefacts(stage, item);
      const bool both = item == std::string("52") && stage == std::string("fpfh");
      EXPECT_THAT(found, SizeIs(both ? 2 : 1)) << stage << " " << item;
      for (const ArtefactFile& file : found) {
        EXPECT_EQ(file.name.item, item);
        EXPECT_EQ(file.stage, stage);
        EXPECT_TRUE(fs::exists(file.path));
      }
    }
  EXPECT_THAT(book.artefacts("fpfh", key_of(recipe())), SizeIs(3));
  EXPECT_THAT(book.artefacts("fpfh", key_of(other)), SizeIs(1));
  EXPECT_THAT(book.artefacts("normals", key_of(other)), IsEmpty());
}

TEST_F(RecipeBookTest, ShortFilesAreListedAndNotBelieved) {
  save("52");
  RecipeBook before(folder_.path());
  fs::resize_file(before.artefacts("fpfh", "52").front().path, 9);
  RecipeBook book(folder_.path());
  ASSERT_THAT(book.artefacts("fpfh", "52"), SizeIs(1));
  const auto reading = read_recipe(book.artefacts("fpfh", "52").front());
  EXPECT_FALSE(reading.recipe);
  EXPECT_THAT(reading.fault, testing::StartsWith("truncated: 9 of "));
  EXPECT_EQ(book.quarantined(key_of(recipe())), nullptr);
  { const FolderStore moves_it_aside(folder_.path(), Access::read_write); }
  RecipeBook after(folder_.path());
  EXPECT_THAT(after.artefacts("fpfh", "52"), IsEmpty());
  ASSERT_NE(after.quarantined(key_of(recipe())), nullptr);
  EXPECT_TRUE(fs::exists(*after.quarantined(key_of(recipe()))));
}

}  // namespace
}  // namespace salbench
