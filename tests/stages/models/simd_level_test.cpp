// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/simd_level.h"

#include <gtest/gtest.h>

#include "stages/models/chi2_kernel.h"

namespace salbench {
namespace {

TEST(SimdLevel, IsThatOfTheKernels) {
  using enum chi2_kernel::Instructions;
  EXPECT_EQ(simd_level() == "avx512", chi2_kernel::supported(avx512));
  EXPECT_EQ(simd_level() == "baseline", !chi2_kernel::supported(avx2));
}

}  // namespace
}  // namespace salbench
