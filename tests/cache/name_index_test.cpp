// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/name_index.h"

#include <algorithm>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/parallel.h"
#include "stages/core/rng.h"

namespace salbench {
namespace {

ArtefactName name(const std::string& item, const Digest& key, const Digest& content = {1, 1}) {
  return {item, key, content, 7, 100};
}

// Beside a map that does the same.
TEST(NameIndex, FindsWhatAMapFinds) {
  Rng rng(1, "names", "");
  NameIndex index;
  std::map<Digest, ArtefactName> twin;
  const auto any_key = [&] { return Digest{std::uint64_t{rng.below(2000)} << 53U, rng.below(3)}; };
  for (int step = 0; step < 20000; ++step) {
    const Digest key = any_key();
    if (rng.below(4) == 0) {
      index.erase("fpfh", key);
      twin.erase(key);
    } else {
      const ArtefactName added = name("item" + std::to_string(rng.below(50)), key, {rng.below(9), 2});
      index.insert("fpfh", {&added, 1});
      const auto known = twin.try_emplace(key, added).first;
      if (added.content < known->second.content) known->second = added;
    }
    const Digest asked = any_key();
    const auto found = index.find("fpfh", asked);
    const auto expected = twin.find(asked);
    ASSERT_EQ(found.has_value(), expected != twin.end());
    if (found) {
      ASSERT_EQ(found->text(), expected->second.text());
    }
  }
  ASSERT_EQ(index.usage().size(), 1U);
  EXPECT_EQ(index.usage()[0].artefacts, twin.size());
  EXPECT_EQ(index.usage()[0].bytes, 100 * twin.size());
}

TEST(NameIndex, StagesAndItemsAreToldApart) {
  NameIndex index;
  const std::vector<ArtefactName> names = {name("52", {1, 1}), name("a_b", {2, 1})};
  index.insert("fpfh", names);
  const ArtefactName other = name("53", {3, 1});
  index.insert("map.PS", {&other, 1});
  EXPECT_TRUE(index.has_item("fpfh", "52"));
  EXPECT_TRUE(index.has_item("fpfh", "a/b")) << "its label is a_b";
  EXPECT_FALSE(index.has_item("fpfh", "53"));
  EXPECT_FALSE(index.has_item("normals", "52"));
  EXPECT_FALSE(index.has_item("map.PS", "52"));
  EXPECT_FALSE(index.find("map.PS", {1, 1}));
  index.erase("fpfh", {1, 1});
  EXPECT_FALSE(index.find("fpfh", {1, 1}));
  EXPECT_TRUE(index.has_item("fpfh", "52")) << "it was there: what comes now is a change";
}

TEST(NameIndex, ManyThreadsMayAddAndAsk) {
  NameIndex index;
  parallel_ranges(1000, 1, [&](std::size_t i, std::size_t) {
    const ArtefactName added = name(std::to_string(i % 10), {i << 54U, i});
    index.insert("fpfh", {&added, 1});
    EXPECT_TRUE(index.find("fpfh", added.key));
  });
  EXPECT_EQ(index.usage()[0].artefacts, 1000U);
}

}  // namespace
}  // namespace salbench
