// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/rng.h"

#include "tests/support/test.h"

namespace salbench {
namespace {

// From the published reference code of SplitMix64 and xoshiro256** and FNV-1a over "stage", 0xff, "item",
// 0xff. Every stored result with random numbers depends on them.
TEST(Rng, IsTheGeneratorThatWasPublished) {
  Rng rng(2016, "RS", "52");
  for (const std::uint64_t expected :
       {0x65c566510ec26261ULL, 0xf83a9a13c12b073bULL, 0x27a00027a3e1468aULL, 0x41d79062c183be30ULL})
    EXPECT_EQ(rng.next(), expected);
  Rng unnamed(0, "", "");
  for (const std::uint64_t expected : {0x8c19dbb9ea5aafadULL, 0xe8235696373960c9ULL, 0x6241540a49a1fe00ULL})
    EXPECT_EQ(unnamed.next(), expected);
}

TEST(Rng, AnyPartOfTheSeedChangesTheStream) {
  std::set<std::uint64_t> first;
  for (const char* item : {"52", "52_0", "5", "2"})
    for (const char* stage : {"RS", "scores.RS"})
      for (const std::uint64_t seed : {0U, 1U, 2016U}) first.insert(Rng(seed, stage, item).next());
  EXPECT_EQ(first.size(), 24U);
  EXPECT_NE(Rng(1, "ab", "c").next(), Rng(1, "a", "bc").next());
}

TEST(Rng, UniformHasTheMomentsOfTheUnitInterval) {
  Rng rng(1, "test", "moments");
  const int n = 200000;
  double sum = 0, squares = 0;
  for (int i = 0; i < n; ++i) {
    const double u = rng.uniform();
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    sum += u;
    squares += u * u;
  }
  EXPECT_NEAR(sum / n, 0.5, 4 * std::sqrt(1.0 / 12 / n));
  EXPECT_NEAR(squares / n, 1.0 / 3, 0.003);
}

TEST(Rng, BelowCoversItsRangeEvenly) {
  Rng rng(1, "test", "below");
  std::array<int, 7> count{};
  for (int i = 0; i < 70000; ++i) ++count[rng.below(7)];
  for (const int c : count) EXPECT_NEAR(c, 10000, 450);
}

TEST(Rng, NormalHasUnitVariance) {
  Rng rng(1, "test", "normal");
  const int n = 100000;
  double sum = 0, squares = 0;
  for (int i = 0; i < n; ++i) {
    const double x = rng.normal();
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / n, 0, 0.015);
  EXPECT_NEAR(squares / n, 1, 0.02);
}

}  // namespace
}  // namespace salbench
