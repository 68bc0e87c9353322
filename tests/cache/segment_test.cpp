// SPDX-License-Identifier: GPL-3.0-or-later
#include "cache/segment.h"

#include "cache/layout.h"
#include "io/hdf5/hdf5_file.h"
#include "stages/core/rng.h"
#include "tests/support/cache_files.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

const Arrays kArrays = {{"fpfh", {900, 33}, std::vector<float>(900 * 33, 0.5F), "1", "packed"},
                        {"empty", {0, 3}, std::vector<double>{}, "m", "no rows"},
                        {"group/one", {}, std::vector<std::int64_t>{1LL << 40}, "1", "a scalar"},
                        {"bytes", {2}, std::vector<std::uint8_t>{1, 255}, "1", ""}};

Recipe recipe(const std::string& stage, int k = 1) {
  return {stage,
          3,
          "k: " + std::to_string(k) + "\n",
          "2016/52",
          {{"mesh: of\nclay", {1, 2}}, {"normals", {3, 4}}}};
}

std::vector<ArtefactPtr> artefacts() {
  const auto made = [](Recipe what, const Arrays& arrays, const std::string& item,
                       const std::string& remark) {
    return std::make_shared<const Artefact>(artefact_of(
        std::move(what), "field", arrays,
        {item, 0.25, remark, {{"program", std::string("ü")}, {"n", std::int64_t{-3}}, {"x", 0.5}}}));
  };
  return {made(recipe("fpfh"), kArrays, "52", "3 loose vertices"),
          made(recipe("fpfh"), {kArrays[3]}, "52_3", ""), made(recipe("map.PS"), {kArrays[0]}, "52", "")};
}

class SegmentTest : public testing::Test {
 protected:
  void SetUp() override { prepare_cache(folder_.path()); }
  fs::path write(const std::vector<ArtefactPtr>& all = artefacts()) const {
    return write_segment(folder_.path(), "52", segment_image(all));
  }
  TemporaryFolder folder_;
};

TEST_F(SegmentTest, GivesBackWhatWasWritten) {
  const auto segment = Segment::open(write());
  ASSERT_TRUE(segment);
  ASSERT_THAT(segment->rows(), SizeIs(3));
  segment->check();
  for (std::size_t i = 0; i < 3; ++i) {
    const ArtefactPtr expected = artefacts()[i];
    const SegmentRow& row = segment->rows()[i];
    EXPECT_EQ(row.stage, expected->recipe.stage);
    EXPECT_EQ(row.item, expected->note.item);
    EXPECT_EQ(row.remark, expected->note.remark);
    EXPECT_EQ(row.bytes, bytes_of(*expected));
    const Artefact found = *segment->read(row, Segment::Part::all);
    EXPECT_EQ(found.key, expected->key);
    EXPECT_EQ(found.content, content_digest(arrays_of(found)));
    EXPECT_EQ(found.recipe.inputs, expected->recipe.inputs);
    EXPECT_EQ(attributes_of(found), attributes_of(*expected));
    const Arrays arrays = arrays_of(found), arrays_before = arrays_of(*expected);
    for (std::size_t a = 0; a < arrays.size(); ++a) {
      EXPECT_EQ(arrays[a].values, arrays_before[a].values);
      EXPECT_EQ(arrays[a].shape, arrays_before[a].shape);
      EXPECT_EQ(arrays[a].unit + arrays[a].description, arrays_before[a].unit + arrays_before[a].description);
    }
    EXPECT_EQ(segment->read(row, Segment::Part::record)->arrays[0].pieces.size(), 0U);
  }
}

TEST_F(SegmentTest, EqualArtefactsGiveEqualBytesAndAnotherNoteAnotherFile) {
  EXPECT_EQ(write(), write());
  auto other = artefacts();
  Artefact changed = *other[0];
  changed.note.seconds = 0.5;
  other[0] = std::make_shared<const Artefact>(changed);
  EXPECT_NE(write(other), write());
}

TEST_F(SegmentTest, ATableMayBeLongerThanWhatIsReadFirst) {
  auto all = artefacts();
  Artefact changed = *all[0];
  std::vector<std::size_t> lengths = {10000};
  for (std::size_t length = 3000; length < 4200; length += 20) lengths.push_back(length);  // 4096 bytes
  for (const std::size_t length : lengths) {
    changed.note.remark = std::string(length, 'x');
    all[0] = std::make_shared<const Artefact>(changed);
    EXPECT_EQ(Segment::open(write(all))->rows()[0].remark, changed.note.remark);
  }
}

TEST_F(SegmentTest, GroupsOfOneNameAreToldApartByTheirKeys) {
  auto all = artefacts();
  all.push_back(
      std::make_shared<const Artefact>(artefact_of(recipe("fpfh", 2), "field", {kArrays[3]}, {"52"})));
  const auto segment = Segment::open(write(all));
  EXPECT_EQ(segment->group(segment->rows()[0]), "fpfh/52." + all[0]->key.hex());
  EXPECT_EQ(segment->group(segment->rows()[1]), "fpfh/52_3");
  EXPECT_EQ(segment->group(segment->rows()[3]), "fpfh/52." + all[3]->key.hex());
}

// Every byte that is read is covered by a checksum; `check` covers the others.
TEST_F(SegmentTest, AFlippedByteAnywhereIsNoticed) {
  const fs::path path = write();
  const std::uint64_t size = fs::file_size(path);
  std::size_t of_head = 0;
  for (std::uint64_t at = 0; at < size; at += at < 4096 ? 1 : 37) {
    flip_byte(path, at);
    bool noticed = false;
    try {
      const auto segment = Segment::open(path);
      std::size_t damaged = 0;
      for (const SegmentRow& row : segment->rows()) {
        try {
          const Artefact artefact = *segment->read(row, Segment::Part::all);
          EXPECT_EQ(content_digest(arrays_of(artefact)), row.content) << at;
        } catch (const InputError&) {
          ++damaged;
        }
      }
      EXPECT_LE(damaged, 1U) << "the others of the file stay sound: " << at;
      noticed = damaged > 0;
      EXPECT_TRUE(!noticed || !damage_in(path).empty()) << at;
      noticed = !damage_in(path).empty();
    } catch (const InputError&) {
      noticed = true;
      ++of_head;
    }
    const bool is_padding = !noticed;
    if (is_padding) {
      EXPECT_EQ(at < size / 2, true) << at;
    }
    flip_byte(path, at);
  }
  EXPECT_GT(of_head, 100U);
  Segment::open(path)->check();
}

// Recomputes the checksums of records and table.
std::uint64_t vouch_for(Bytes& head) {
  constexpr std::size_t kTableAt = 24, kRowsAt = kTableAt + 5 * 8,
                        kOfRow = 32;         // each row begins with two digests
  const auto number = [&](std::size_t at) {  // unaligned
    std::uint64_t value = 0;
    std::memcpy(&value, head.data() + at, sizeof value);
    return value;
  };
  const auto set_sum = [&](std::size_t at, std::size_t begin, std::size_t size) {
    const std::uint64_t sum = checksum(std::span(head).subspan(begin, size));
    std::memcpy(head.data() + at, &sum, sizeof sum);
    return sum;
  };
  std::size_t row = kRowsAt;
  for (std::uint64_t left = number(kRowsAt - 8); left > 0; --left) {
    set_sum(row + kOfRow + 24, number(row + kOfRow + 8), number(row + kOfRow + 16));
    row += kOfRow + 32;
    for (int text = 0; text < 3; ++text) row += 8 + number(row);
  }
  return set_sum(16, kTableAt, number(kTableAt + 8));
}

// Deliberate damage with valid checksums. Sanitizers detect the effects of wrong sizes, positions and counts.
TEST_F(SegmentTest, DamageThatChecksumsVouchForIsReadOrRefused) {
  const SegmentImage sound = segment_image(artefacts());
  const std::size_t records = Segment::open(write())->rows().front().at;
  Rng rng(1, "damage", "");
  std::size_t refused = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    SegmentImage image = sound;
    for (int change = 0; change < 3; ++change)
      image.head[records + rng.below(1200)] =
          static_cast<std::byte>(rng.below(2) == 0 ? 0xff : rng.below(256));
    image.checksum = vouch_for(image.head);
    const fs::path path = write_segment(folder_.path(), "52", image);
    const auto segment = Segment::open(path);
    for (const SegmentRow& row : segment->rows()) try {
        if (const auto artefact = segment->read(row, Segment::Part::all)) arrays_of(*artefact);
      } catch (const InputError&) {
        ++refused;
      }
    fs::remove(path);
  }
  EXPECT_GT(refused, 500U);
}

TEST_F(SegmentTest, AFileOfAnyOtherLengthIsDamaged) {
  const fs::path path = write();
  const std::uint64_t size = fs::file_size(path);
  for (std::uint64_t length = 0; length < size; length += 61) {
    const fs::path copy = folder_ / path.filename();
    fs::copy_file(path, copy, fs::copy_options::overwrite_existing);
    fs::resize_file(copy, length);
    EXPECT_THAT(damage_in(copy), AnyOf(HasSubstr("truncated"), HasSubstr("checksum mismatch"))) << length;
  }
  fs::resize_file(path, size + 1);
  EXPECT_THAT(damage_in(path), HasSubstr("too long"));
}

TEST_F(SegmentTest, OtherFilesAreRefusedAndAMissingOneIsNone) {
  EXPECT_FALSE(Segment::open(folder_ / "missing.h5"));
  const Bytes image = hdf5_image({kArrays, {}});
  const std::string hdf5(reinterpret_cast<const char*>(image.data()), image.size());
  for (const auto& [bytes, why] : {std::pair(std::string(600, 'x'), "not a file of a cache"),
                                   {"x", "truncated: 1 bytes"},
                                   {hdf5, "not a file of a cache"}}) {
    const fs::path file = folder_.write("a.h5", bytes);
    EXPECT_THAT([&] { Segment::open(file); }, Refuses(why));
  }
}

}  // namespace
}  // namespace salbench
