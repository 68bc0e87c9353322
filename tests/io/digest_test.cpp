// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/digest.h"

#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(Digest, HexHas32Digits) {
  const Digest digest{0x0123456789abcdefULL, 42};
  EXPECT_EQ(digest.hex(), "0123456789abcdef000000000000002a");
}

TEST(Hasher, TextsDoNotRunIntoEachOther) {
  const auto hashed = [](std::initializer_list<std::string_view> texts) {
    Hasher hasher;
    for (const std::string_view text : texts) hasher.add(text);
    return hasher.digest();
  };
  const std::set<Digest> digests = {hashed({"ab", "c"}), hashed({"a", "bc"}), hashed({"abc"}),
                                    hashed({"abc", ""}), hashed({"", "abc"}), hashed({"a", "b", "c"})};
  EXPECT_EQ(digests.size(), 6U);
  EXPECT_EQ(hashed({"ab", "c"}), hashed({"ab", "c"}));
}

TEST(ContentDigest, SeesNamesShapesTypesAndValuesButNoProse) {
  const Arrays base = {{"a", {2, 1}, std::vector<double>{1, 2}, "m", "text"}};
  const Digest digest = content_digest(base);
  auto changed = [&](auto change) {
    Arrays copy = base;
    change(copy[0]);
    return content_digest(copy);
  };
  EXPECT_EQ(digest, changed([](Array& a) { a.description = "other"; }));
  EXPECT_NE(digest, changed([](Array& a) { a.name = "b"; }));
  EXPECT_NE(digest, changed([](Array& a) { a.shape = {1, 2}; }));
  EXPECT_NE(digest, changed([](Array& a) { a.values = std::vector<double>{1, 3}; }));
  EXPECT_NE(digest, changed([](Array& a) { a.values = std::vector<std::int64_t>{1, 2}; }));
}

TEST(ContentDigest, DoesNotDependOnTheOrderOfArrays) {
  const Array a{"a", {1}, std::vector<double>{1}, "1", ""}, b{"b", {1}, std::vector<double>{2}, "1", ""};
  EXPECT_EQ(content_digest({a, b}), content_digest({b, a}));
}

TEST(Xxh128, IsWhatXxh128sumPrints) {
  EXPECT_EQ(xxh128("").hex(), "99aa06d3014798d86001c324468d497f");
  EXPECT_NE(xxh128("a"), file_digest("a")) << "keys have another digest";
}

}  // namespace
}  // namespace salbench
