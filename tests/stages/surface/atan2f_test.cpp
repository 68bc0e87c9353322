// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/surface/atan2f.h"

#include <bit>

#include "stages/core/rng.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

float angle(float y, float x) { return salbench_atan2f(y, x); }

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// From glibc 2.36. Correctly rounded, the first eight would be neighbours of these.
TEST(Atan2f, HasTheBitsOfGlibcBefore241) {
  struct Known {
    float y, x, angle;
  };
  for (const auto& [y, x, expected] :
       std::initializer_list<Known>{{0x1.2d07bcp-1F, -0x1.1f2c64p-1F, 0x1.2a93fcp+1F},
                                    {-0x1.c3311ap-2F, 0x1.b2b458p-1F, -0x1.ea3136p-2F},
                                    {0x1.3dd3d6p-1F, -0x1.aeaf94p-1F, 0x1.40bf8p+1F},
                                    {0x1.08ba2ap-1F, 0x1.52cfbep-1F, 0x1.5396b8p-1F},
                                    {0x1.26335cp-1F, 0x1.8cbf4ep-1F, 0x1.46afb4p-1F},
                                    {0x1.d4e3cep-1F, -0x1.a86526p-4F, 0x1.aef6fp+0F},
                                    {-0x1.a4405ep-1F, -0x1.63a6ecp-4F, -0x1.ad1ac6p+0F},
                                    {-0x1.1daaa8p-1F, 0x1.0eec16p-3F, -0x1.568712p+0F},
                                    {0, 1, 0},
                                    {0, -1, 0x1.921fb6p+1F},
                                    {1, 0, 0x1.921fb6p+0F},
                                    {-1, -0.0F, -0x1.921fb6p+0F},
                                    {1, 0x1p-40F, 0x1.921fb6p+0F},
                                    {1, -0x1p-40F, 0x1.921fb4p+0F},
                                    {1, 0x1p-61F, 0x1.921fb6p+0F},
                                    {0x1p-61F, -1, 0x1.921fb6p+1F},
                                    {kInfinity, -kInfinity, 0x1.2d97c8p+1F},
                                    {0x1p-100F, 0x1p-100F, 0x1.921fb6p-1F},
                                    {-3, 4, -0x1.4978fap-1F}})
    EXPECT_EQ(angle(y, x), expected) << y << ", " << x;
  EXPECT_TRUE(std::signbit(angle(-0.0F, 1)));
  EXPECT_TRUE(std::isnan(angle(std::nanf(""), 1)) && std::isnan(angle(1, std::nanf(""))));
}

TEST(Atan2f, IsTheAngleToTheRoundingOfAFloat) {
  Rng rng(1, "atan2f", "test");
  for (int i = 0; i < 100000; ++i) {
    const auto bits = [&] {
      return std::bit_cast<float>(static_cast<std::uint32_t>(rng.below(1ULL << 32U)));
    };
    const float y = bits(), x = bits();
    if (std::isnan(y) || std::isnan(x)) continue;
    const double exact = std::atan2(static_cast<double>(y), static_cast<double>(x));
    EXPECT_NEAR(angle(y, x), exact, 2e-7 * std::abs(exact) + 1e-45) << y << ", " << x;
  }
}

}  // namespace
}  // namespace salbench
