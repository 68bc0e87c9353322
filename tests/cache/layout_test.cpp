// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/layout.h"

#include "cache/artefact.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(SegmentName, ComesBackAsItWasWritten) {
  for (const SegmentName& name : {SegmentName{"52", 1}, SegmentName{"", ~0ULL}, SegmentName{"a-b_c", 0}}) {
    const auto back = parse_segment_name(name.text());
    ASSERT_TRUE(back) << name.text();
    EXPECT_EQ(back->label, name.label);
    EXPECT_EQ(back->checksum, name.checksum);
  }
  EXPECT_EQ((SegmentName{"52", 0x2a}.text()), "52.000000000000002a.h5");
}

TEST(SegmentName, OtherNamesAreNone) {
  for (const char* name :
       {"", ".h5", "52.h5", "52.2a.h5", "52.000000000000002a", "52.00000000000000zz.h5", "notes.txt"})
    EXPECT_FALSE(parse_segment_name(name)) << name;
}

TEST(ItemLabel, KeepsWhatAFileNameTakes) {
  EXPECT_EQ(item_label("bull horn/3.x"), "bull_horn_3_x");
  EXPECT_EQ(item_label(std::string(70, 'a')), std::string(60, 'a'));
}

TEST(CacheLayout, SegmentsLieInTheFolderOfTheirFamily) {
  const TemporaryFolder folder;
  prepare_cache(folder.path());
  const std::string name = SegmentName{"52", 1}.text(), other = SegmentName{"53", 1}.text();
  const auto file = folder.write((segment_folder("52") / name).string(), "x");
  folder.write((segment_folder("52") / other).string(), "x");
  folder.write((segment_folder("") / SegmentName{"", 5}.text()).string(), "x");
  folder.write((segment_folder("52") / "deep" / name).string(), "x");
  folder.write((segment_folder("52") / "readme").string(), "x");
  folder.write("damaged/" + name, "x");
  folder.write("loose", "x");
  EXPECT_THAT(list_segments(folder.path()), SizeIs(3));
  EXPECT_EQ(count_other_files(folder.path()), 3U);
  ASSERT_THAT(list_segments(folder.path(), "52"), SizeIs(1));
  EXPECT_EQ(list_segments(folder.path(), "52")[0], file);
  EXPECT_THAT(list_segments(folder / "missing"), IsEmpty());
}

}  // namespace
}  // namespace salbench
