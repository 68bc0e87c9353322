// SPDX-License-Identifier: GPL-3.0-or-later
// Writer and reader against the library: each reads what the other wrote.
#include "io/hdf5/hdf5_image.h"

#include <limits>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/rng.h"
#include "tests/support/hdf5_content.h"

namespace salbench {
namespace {

using namespace hdf5;

template <class T>
std::vector<T> random_values(Rng& rng, std::size_t count) {
  std::vector<T> values(count);
  for (T& value : values) value = static_cast<T>(rng.below(3) == 0 ? rng.below(256) : 0);
  return values;
}

ArrayValues random_array(Rng& rng, std::size_t count) {
  switch (rng.below(5)) {
    case 0:
      return random_values<double>(rng, count);
    case 1:
      return random_values<float>(rng, count);
    case 2:
      return random_values<std::int32_t>(rng, count);
    case 3:
      return random_values<std::int64_t>(rng, count);
    default:
      return random_values<std::uint8_t>(rng, count);
  }
}

std::string random_text(Rng& rng, std::size_t longest) {
  std::string text;
  for (std::size_t left = rng.below(longest + 1); left > 0; --left)
    text += static_cast<char>('a' + rng.below(26));
  return text;
}

// In the order of the names, as readers give them back. Names in groups are longer than their groups'
// neighbours, so that one order by whole names is that by their parts.
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
    switch (rng.below(4)) {
      case 0:
        content.attributes.emplace_back(name, static_cast<double>(rng.below(1000)) / 7);
        break;
      case 1:
        content.attributes.emplace_back(name, -static_cast<std::int64_t>(rng.below(1U << 30U)));
        break;
      case 2:
        content.attributes.emplace_back(name, random_text(rng, 40'000));
        break;
      default:
        content.attributes.emplace_back(name, random_text(rng, 12));
        break;
    }
  }
  return content;
}

TEST(Hdf5Image, LibraryAndReaderGetOutWhatWriterAndLibraryPutIn) {
  for (std::uint64_t number = 0; number < 60; ++number) {
    SCOPED_TRACE(number);
    const Hdf5Content content = random_content(number);
    const auto own = written_image(content);
    ASSERT_TRUE(own);
    const Bytes other = image_by_library(content);
    const auto parsed_own = parsed_image(*own), parsed_other = parsed_image(other);
    ASSERT_TRUE(parsed_own);
    ASSERT_TRUE(parsed_other);
    expect_equal(*parsed_own, content);
    expect_equal(*parsed_other, content);
    expect_equal(content_by_library(*own), content);
  }
}

// Chunks are shared out so that one node of the index holds them.
TEST(Hdf5Image, ArraysOfMoreRowsThanSmallChunksHold) {
  for (const std::size_t rows : {262'144U, 262'145U, 700'000U}) {
    std::vector<float> values(rows);
    for (std::size_t i = 0; i < rows; ++i) values[i] = static_cast<float>(i % 1000);
    const Hdf5Content content{{{"a", {rows}, std::move(values), "1", ""}}, {}};
    const Bytes image = written_image(content).value();
    EXPECT_LT(image.size(), rows * 2);
    expect_equal(parsed_image(image).value(), content);
    expect_equal(content_by_library(image), content);
  }
}

TEST(Hdf5Image, TextsTooLongForAnObjectHeaderAreLeftToTheLibrary) {
  const auto with_text = [](std::size_t bytes) {
    return Hdf5Content{{}, {{"inputs", std::string(bytes, 'x')}}};
  };
  expect_equal(content_by_library(written_image(with_text(60'000)).value()), with_text(60'000));
  EXPECT_FALSE(written_image(with_text(60'001)));
  EXPECT_FALSE(parsed_image(image_by_library(with_text(60'001))));
}

TEST(Hdf5Image, NoBeginningOfAnImageIsOne) {
  const Bytes image = written_image(random_content(5)).value();
  for (std::size_t size = 0; size < image.size(); size += size < 2000 ? 1 : 97)
    ASSERT_FALSE(parsed_image(std::span(image).first(size))) << size;
}

// Sanitizers see what a damaged address, size or count would lead to.
TEST(Hdf5Image, DamagedImagesAreReadOrLeftAlone) {
  const Bytes sound = written_image(random_content(8)).value();
  Rng rng(1, "damage", "");
  std::size_t left_alone = 0;
  for (int trial = 0; trial < 20'000; ++trial) {
    Bytes image = sound;
    for (int change = 0; change < 4; ++change)
      image[rng.below(image.size())] = static_cast<std::byte>(rng.below(2) == 0 ? 0xff : rng.below(256));
    if (const auto content = parsed_image(image))
      EXPECT_LE(content->arrays.size(), image.size() / 16);
    else
      ++left_alone;
  }
  EXPECT_GT(left_alone, 1000U);
}

TEST(Hdf5Image, AGroupThatHoldsItselfIsLeftAlone) {
  Bytes image = written_image({{{"a/b", {1}, std::vector<double>{1}, "1", ""}}, {}}).value();
  // The root's symbols lead to the root in place of "a": its address stands in bytes 64 to 71 of the
  // superblock.
  const std::string_view bytes(reinterpret_cast<const char*>(image.data()), image.size());
  const std::size_t symbols = bytes.rfind("SNOD");
  std::copy_n(image.begin() + 64, 8, image.begin() + static_cast<std::ptrdiff_t>(symbols) + 16);
  EXPECT_FALSE(parsed_image(image));
}

}  // namespace
}  // namespace salbench
