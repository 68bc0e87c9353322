// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of the chi-square search for each variant by its name: what a machine lacks is seen to be skipped.
#pragma once

#include <array>
#include <string>

#include <gtest/gtest.h>

#include "stages/models/chi2_kernel.h"

namespace salbench {

class Chi2VariantTest : public testing::TestWithParam<chi2_kernel::Instructions> {
 protected:
  void SetUp() override {
    if (!chi2_kernel::supported(GetParam())) GTEST_SKIP() << "this machine lacks these instructions";
  }
};

inline auto every_chi2_variant() {
  using enum chi2_kernel::Instructions;
  return testing::Values(baseline, avx2, avx512);
}

inline std::string name_of_chi2_variant(const testing::TestParamInfo<chi2_kernel::Instructions>& test) {
  constexpr std::array names = {"baseline", "avx2", "avx512"};
  return names[static_cast<std::size_t>(test.param)];
}

}  // namespace salbench
