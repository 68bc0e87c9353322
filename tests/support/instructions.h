// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of the kernels for each instruction set by name: those that a machine lacks are reported as skipped.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/highway.h>

namespace salbench {

// Restricts kernels to the parameter's instruction set during such a test, and lifts the limit afterwards.
class InstructionsTest : public testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override {
    if ((hwy::SupportedTargets() & GetParam()) == 0 && GetParam() != HWY_STATIC_TARGET)
      GTEST_SKIP() << "this machine lacks these instructions";
    hwy::SetSupportedTargetsForTest(GetParam());
  }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

inline auto every_instruction_set() {
  std::vector<std::int64_t> all;
  for (std::int64_t targets = HWY_TARGETS; targets != 0; targets &= targets - 1)
    all.push_back(targets & -targets);
  return testing::ValuesIn(all);
}

inline std::string name_of_instructions(const testing::TestParamInfo<std::int64_t>& test) {
  return hwy::TargetName(test.param);
}

}  // namespace salbench
