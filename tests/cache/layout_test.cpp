// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/cache_files.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(CacheLayout, StagesAreTheFoldersThatAreNotTheCachesOwn) {
  const TemporaryFolder folder;
  prepare_cache(folder.path());
  EXPECT_THAT(list_stages(folder.path()), IsEmpty());
  folder.write("map.PS/00/x", "");
  folder.write("fpfh/00/x", "");
  folder.write("damaged/x", "");
  folder.write("notes.txt", "a file of somebody's");
  EXPECT_THAT(list_stages(folder.path()), ElementsAre("fpfh", "map.PS"));
}

TEST(CacheLayout, ArtefactsLieInTheFolderOfTheirStageAndShard) {
  const TemporaryFolder folder;
  const Digest key{0xab00000000000000, 1};
  const ArtefactName name{"52", key, {2, 3}, 4, 5};
  EXPECT_EQ(shard_of("fpfh", key), std::filesystem::path("fpfh/ab"));
  const auto artefact = folder.write("fpfh/ab/" + name.text(), "x");
  folder.write("fpfh/" + name.text(), "x");
  folder.write("fpfh/ab/deep/" + name.text(), "x");
  folder.write("loose", "x");
  EXPECT_EQ(list_cache(folder.path()).artefacts, 1U);
  EXPECT_EQ(list_cache(folder.path()).others, 3U);
  const auto artefacts = artefacts_of(folder.path());
  ASSERT_EQ(artefacts.size(), 1U);
  EXPECT_EQ(artefacts[0].path, artefact);
  EXPECT_EQ(artefacts[0].stage, "fpfh");
  EXPECT_EQ(find_artefacts(folder.path(), "fpfh", key).size(), 1U);
  EXPECT_THAT(find_artefacts(folder.path(), "fpfh", {0xab00000000000000, 2}), IsEmpty());
}

}  // namespace
}  // namespace salbench
