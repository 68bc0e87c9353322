// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hdf5/head.h"

#include <fmt/format.h>

#include "stages/core/rng.h"
#include "tests/support/image_head.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

void expect_equal(const Hdf5Content& a, const Hdf5Content& b) {
  ASSERT_EQ(a.arrays.size(), b.arrays.size());
  for (std::size_t i = 0; i < a.arrays.size(); ++i) {
    SCOPED_TRACE(b.arrays[i].name);
    EXPECT_EQ(a.arrays[i].name, b.arrays[i].name);
    EXPECT_EQ(a.arrays[i].shape, b.arrays[i].shape);
    EXPECT_EQ(a.arrays[i].values, b.arrays[i].values);
    EXPECT_EQ(a.arrays[i].unit, b.arrays[i].unit);
    EXPECT_EQ(a.arrays[i].description, b.arrays[i].description);
  }
  EXPECT_EQ(a.attributes, b.attributes);
}

template <class T>
std::vector<T> random_values(Rng& rng, std::size_t count) {
  std::vector<T> values(count);
  for (T& value : values) value = static_cast<T>(rng.below(3) == 0 ? rng.below(256) : 0);
  return values;
}

ArrayValues random_array(Rng& rng, std::size_t count) {
  const std::array<ArrayValues, 5> of_each_type = {
      random_values<double>(rng, count), random_values<float>(rng, count),
      random_values<std::int32_t>(rng, count), random_values<std::int64_t>(rng, count),
      random_values<std::uint8_t>(rng, count)};
  return of_each_type[rng.below(5)];
}

std::string random_text(Rng& rng, std::size_t longest) {
  std::string text;
  for (std::size_t left = rng.below(longest + 1); left > 0; --left)
    text += static_cast<char>('a' + rng.below(26));
  return text;
}

// Sorted by name, as the library returns arrays. Names in groups are longer than their groups' neighbours, so
// that sorting whole names equals sorting by parts.
Hdf5Content random_content(std::uint64_t number) {
  Rng rng(number, "image", "");
  Hdf5Content content;
  const std::size_t arrays = rng.below(40);
  for (std::size_t a = 0; a < arrays; ++a) {
    std::string name = fmt::format("{}{:02}{}",
                                   rng.below(2) == 0 ? ""
                                   : a < 20          ? "1/x/"
                                                     : "2/",
                                   a, random_text(rng, 20));
    std::vector<std::size_t> shape;
    std::size_t count = 1;
    for (std::size_t rank = rng.below(4); rank > 0; --rank)
      count *= shape.emplace_back(rng.below(number % 4 == 0 ? 60 : 6));
    content.arrays.push_back({std::move(name), std::move(shape), random_array(rng, count),
                              random_text(rng, 3), random_text(rng, 90), rng.below(2) == 0});
  }
  std::ranges::sort(content.arrays, {}, &Array::name);
  for (std::size_t a = rng.below(30); a > 0; --a) {
    const std::string name = fmt::format("{:02} {}", 30 - a, random_text(rng, 9));
    const AttributeValue of_each_type[] = {static_cast<double>(rng.below(1000)) / 7,
                                           -static_cast<std::int64_t>(rng.below(1U << 30U)),
                                           random_text(rng, 40'000), random_text(rng, 12)};
    content.attributes.emplace_back(name, of_each_type[rng.below(4)]);
  }
  return content;
}

// A newer superblock has its addresses elsewhere.
TEST(Head, AnHdf5FileOfAnotherVersionIsNotMoved) {
  Bytes part = hdf5_image({{{"a", {1}, std::vector<double>{1}, "1", ""}}, {}});
  constexpr std::size_t kVersionAt = 8;
  EXPECT_EQ(part.at(kVersionAt), std::byte{0});
  EXPECT_NO_THROW(move_behind(512, part));
  for (const int newer : {2, 3}) {
    part.at(kVersionAt) = static_cast<std::byte>(newer);
    EXPECT_THROW(move_behind(512, part), std::logic_error) << newer;
  }
}

TEST(Head, GivesOutWhatWasPutIn) {
  for (std::uint64_t number = 0; number < 60; ++number) {
    SCOPED_TRACE(number);
    const Hdf5Content content = random_content(number);
    const Bytes image = image_with_head(content);
    const auto found = content_by_head(image);
    ASSERT_TRUE(found);
    expect_equal(*found, content);
    EXPECT_EQ(attributes_by_head(image), content.attributes);
    EXPECT_EQ(image_with_head(content), image) << "equal content, equal bytes";
  }
}

// Chunks are sized so that one node of HDF5's index holds them.
TEST(Head, ArraysOfMoreRowsThanSmallChunksHold) {
  for (const std::size_t rows : {262'144U, 262'145U, 700'000U}) {
    std::vector<float> values(rows);
    for (std::size_t i = 0; i < rows; ++i) values[i] = static_cast<float>(i % 1000);
    const Hdf5Content content{{{"a", {rows}, std::move(values), "1", ""}}, {}};
    const Bytes image = image_with_head(content);
    EXPECT_LT(image.size(), rows * 2);
    expect_equal(content_by_head(image).value(), content);
  }
}

TEST(Head, BytesThatWereChangedAreNotOurs) {
  const Bytes image = image_with_head(random_content(5));
  for (std::size_t size = 0; size < image.size(); size += size < 2000 ? 1 : 997)
    ASSERT_FALSE(content_by_head(std::span(image).first(size))) << size;
  for (std::size_t at = 0; at < image.size(); at += 1 + image.size() / 300) {
    Bytes changed = image;
    changed[at] ^= std::byte{1};
    ASSERT_FALSE(content_by_head(changed)) << at;
    ASSERT_FALSE(attributes_by_head(changed)) << at;
  }
}

// Sanitizers detect the effects of wrong sizes, positions and counts.
TEST(Head, DamageThatAChecksumVouchesForIsReadOrLeftAlone) {
  const Bytes sound = image_with_head({random_content(8).arrays, {}});
  Rng rng(1, "damage", "");
  std::size_t left_alone = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    Bytes image = sound;
    for (int change = 0; change < 4; ++change)
      image[rng.below(2000)] = static_cast<std::byte>(rng.below(2) == 0 ? 0xff : rng.below(256));
    left_alone += content_by_head(vouched_for(std::move(image))) ? 0U : 1U;
  }
  EXPECT_GT(left_alone, 1000U);
}

}  // namespace
}  // namespace salbench
