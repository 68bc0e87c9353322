// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/entry_table.h"

#include "stages/core/parallel.h"
#include "stages/core/rng.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

EntryTable::Entry entry(const Digest& content, std::uint32_t file = 0) { return {content, 100, file, 0}; }

void insert(EntryTable& table, std::string_view stage, std::string_view item, const Digest& key,
            const EntryTable::Entry& added) {
  const EntryTable::Row row{stage, item, key, added};
  table.insert({&row, 1});
}

// Compared with a std::multimap.
TEST(EntryTable, FindsWhatAMapFinds) {
  Rng rng(1, "entries", "");
  EntryTable table;
  std::multimap<Digest, EntryTable::Entry> twin;
  for (std::uint32_t step = 0; step < 5000; ++step) {
    const Digest key{rng.below(500), 1};
    const auto [first, last] = twin.equal_range(key);
    if (rng.below(4) == 0 && first != last) {
      table.erase(key, first->second);
      twin.erase(first);
    } else {
      const EntryTable::Entry added = entry({rng.below(9), 2}, step);
      insert(table, "fpfh", "52", key, added);
      twin.emplace(key, added);
    }
    const Digest asked{rng.below(500), 1};
    std::vector<Digest> expected, found;
    const auto [begin, end] = twin.equal_range(asked);
    for (auto known = begin; known != end; ++known) expected.push_back(known->second.content);
    for (const EntryTable::Entry& known : table.find(asked)) found.push_back(known.content);
    std::ranges::sort(expected);
    ASSERT_EQ(found, expected) << "the smallest content first";
  }
}

TEST(EntryTable, StagesAndItemsAreToldApart) {
  EntryTable table;
  insert(table, "fpfh", "52", {1, 1}, entry({1, 2}));
  insert(table, "fpfh", "a_b", {2, 1}, entry({1, 2}));
  insert(table, "map.PS", "53", {3, 1}, entry({1, 2}));
  EXPECT_TRUE(table.has_item("fpfh", "52"));
  EXPECT_TRUE(table.has_item("fpfh", "a/b")) << "its label is a_b";
  EXPECT_FALSE(table.has_item("fpfh", "53"));
  EXPECT_FALSE(table.has_item("normals", "52"));
  EXPECT_FALSE(table.has_item("map.PS", "52"));
  ASSERT_THAT(table.usage(), SizeIs(2));
  EXPECT_EQ(table.usage()[0].stage, "fpfh");
  EXPECT_EQ(table.usage()[0].artefacts, 2U);
  EXPECT_EQ(table.usage()[0].bytes, 200U);
  table.erase({1, 1}, entry({1, 2}));
  EXPECT_THAT(table.find({1, 1}), IsEmpty());
  EXPECT_TRUE(table.has_item("fpfh", "52")) << "it was there: what comes now is a change";
}

TEST(EntryTable, ManyThreadsMayAddAndAsk) {
  EntryTable table;
  parallel_ranges(1000, 1, [&](std::size_t i, std::size_t) {
    insert(table, "fpfh", std::to_string(i % 10), {i, i}, entry({i, 0}));
    EXPECT_THAT(table.find({i, i}), SizeIs(1));
  });
  EXPECT_EQ(table.usage()[0].artefacts, 1000U);
}

}  // namespace
}  // namespace salbench
