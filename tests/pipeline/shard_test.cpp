// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/inputs/shard.h"

#include "stages/core/rng.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

Item item_of_size(const TemporaryFolder& folder, const std::string& name, std::size_t bytes) {
  return {.name = name, .file = folder.write(name + ".off", std::string(bytes, 'x'))};
}

std::vector<std::string> names(const std::vector<Item>& items) {
  std::vector<std::string> result;
  for (const Item& item : items) result.push_back(item.name);
  return result;
}

TEST(Shard, GivesTheLargestFirstToTheShareThatHasLeast) {
  const TemporaryFolder folder;
  std::vector<Item> items;
  for (const auto& [name, size] : {std::pair("a", 10), {"b", 60}, {"c", 50}, {"d", 20}, {"e", 20}})
    items.push_back(item_of_size(folder, name, static_cast<std::size_t>(size)));
  EXPECT_THAT(names(share_of(items, {1, 2})), ElementsAre("b", "e"));       // 60 + 20
  EXPECT_THAT(names(share_of(items, {2, 2})), ElementsAre("a", "c", "d"));  // 50 + 20 + 10
}

TEST(Shard, SharesAreDisjointCompleteAndBalanced) {
  const TemporaryFolder folder;
  Rng rng(1, "shards", "");
  std::vector<Item> items;
  std::size_t total = 0, largest = 0;
  for (int i = 0; i < 60; ++i) {
    const std::size_t size = 100 + rng.below(4000);
    total += size;
    largest = std::max(largest, size);
    items.push_back(item_of_size(folder, std::to_string(i), size));
  }
  for (const int count : {1, 2, 3, 7, 60, 70}) {
    std::vector<std::string> all;
    for (int index = 1; index <= count; ++index) {
      std::size_t bytes = 0;
      for (const Item& item : share_of(items, {index, count})) {
        bytes += std::filesystem::file_size(item.file);
        all.push_back(item.name);
      }
      // The share that receives an item has at most the mean without it.
      EXPECT_LE(bytes, total / static_cast<std::size_t>(count) + largest) << index << "/" << count;
    }
    EXPECT_THAT(all, testing::UnorderedElementsAreArray(names(items)));
  }
}

TEST(Shard, MeshesThatAreNotThereAreSharedOutToo) {
  std::vector<Item> items;
  for (const char* name : {"a", "b", "c", "d"}) items.push_back({.name = name, .file = "/no/such.off"});
  EXPECT_THAT(names(share_of(items, {1, 2})), ElementsAre("a", "c"));
  EXPECT_THAT(names(share_of(items, {2, 2})), ElementsAre("b", "d"));
}

TEST(Shard, IsWrittenAsTwoNumbers) {
  EXPECT_EQ(parse_shard("2/4").index, 2);
  EXPECT_EQ(parse_shard("2/4").count, 4);
  EXPECT_EQ(parse_shard("2/4").text(), "2/4");
  for (const char* bad : {"", "2", "0/4", "5/4", "-1/4", "1/0", "a/4", "1/b", "1/2/3", "1 /2", "/"})
    EXPECT_THROW(parse_shard(bad), ConfigError) << bad;
}

}  // namespace
}  // namespace salbench
