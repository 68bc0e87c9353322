// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/recipes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cache/folder_store.h"
#include "tests/support/cache_files.h"
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
  void save(const std::string& item, const Recipe& what = recipe(), const std::string& family = "52") const {
    FolderStore store(folder_.path(), Access::read_write);
    store.save(family,
               artefact_of(what, "field", {{"saliency", {1}, std::vector<double>{1}, "1", "one value"}},
                           {item, 0.5}));
    store.sync();
  }
  TemporaryFolder folder_;
};

TEST_F(RecipeBookTest, ReadsBackWhatWasSaved) {
  save("a/b");
  const auto found = RecipeBook(folder_.path()).find("52", "fpfh", "a/b");
  ASSERT_THAT(found, SizeIs(1));
  ASSERT_TRUE(found[0].recipe);
  EXPECT_EQ(key_of(*found[0].recipe), key_of(recipe()));
  EXPECT_THAT(fault_of(found[0]), IsEmpty());
}

TEST_F(RecipeBookTest, TellsFamiliesStagesAndItemsApart) {
  Recipe map = recipe(), other = recipe();
  map.stage = "map.PS";
  other.seed = "2/52";
  for (const char* item : {"5", "52", "52_3"}) {
    save(item);
    save(item, map);
  }
  save("52", other);
  save("meshes", map, "");
  RecipeBook book(folder_.path());
  for (const char* item : {"52", "52", "5", "52_3", "52"})
    for (const char* stage : {"fpfh", "map.PS"}) {
      const auto found = book.find("52", stage, item);
      const bool both = item == std::string("52") && stage == std::string("fpfh");
      EXPECT_THAT(found, SizeIs(both ? 2 : 1)) << stage << " " << item;
      for (const KnownArtefact& artefact : found) {
        EXPECT_EQ(artefact.label, item);
        EXPECT_EQ(artefact.stage, stage);
        EXPECT_TRUE(fs::exists(artefact.file));
      }
    }
  EXPECT_EQ(book.read(), 7U);
  EXPECT_THAT(book.find("", "map.PS", "meshes"), SizeIs(1));
  EXPECT_THAT(book.find("53", "map.PS", "52"), IsEmpty());
  const Digest key = book.find("52", "map.PS", "52")[0].key;
  EXPECT_THAT(book.find("52", "map.MINE", "52", key), SizeIs(1)) << "under another name";
  EXPECT_THAT(RecipeBook(folder_ / "not-there").find("52", "fpfh", "52"), IsEmpty());
  EXPECT_THAT(artefacts_of(folder_.path()), SizeIs(8));
}

TEST_F(RecipeBookTest, DamagedOnesAreListedAndNotBelieved) {
  save("52");
  damage(folder_.path(), "fpfh", "52");
  const auto found = RecipeBook(folder_.path()).find("52", "fpfh", "52");
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_FALSE(found[0].recipe);
  EXPECT_THAT(fault_of(found[0]), testing::StartsWith("checksum mismatch"));
  fs::resize_file(found[0].file, 9);
  EXPECT_THAT(RecipeBook(folder_.path()).find("52", "fpfh", "52"), IsEmpty()) << "nobody knows what it had";
}

}  // namespace
}  // namespace salbench
