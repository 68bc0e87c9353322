#include "io/records.h"

#include <gtest/gtest.h>

namespace salbench {
namespace {

TEST(Records, LieBehindEachOther) {
  const Records records =
      records_from({{"item", "n", "auc"}, {{"52", std::int64_t{7}, 0.5}, {"125_3", std::int64_t{-1}, -2.0}}});
  ASSERT_EQ(records.fields.size(), 3U);
  EXPECT_EQ(records.fields[0].size, 5U);
  EXPECT_EQ(records.fields[1].offset, 5U);
  EXPECT_EQ(records.fields[2].offset, 13U);
  EXPECT_EQ(record_size(records.fields), 21U);
  EXPECT_EQ(records.bytes.size(), 42U);
  EXPECT_EQ(records.bytes[2], std::byte{0});  // "52" is filled up
}

TEST(Records, OfTextsThatAreAllEmptyHaveASize) {
  EXPECT_EQ(records_from({{"view"}, {{""}, {""}}}).bytes.size(), 2U);
}

TEST(Records, ColumnsThatMixTypesAreRefused) {
  EXPECT_THROW(records_from({{"a"}, {{"x"}, {0.5}}}), std::logic_error);
}

}  // namespace
}  // namespace salbench
