// SPDX-License-Identifier: GPL-3.0-or-later
// Included by every C++ test: GoogleTest, the standard headers that most tests need, and common names.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/errors.h"

namespace salbench {

namespace fs = std::filesystem;

using testing::AllOf, testing::AnyOf, testing::Contains, testing::DoubleNear, testing::Each,
    testing::ElementsAre;
using testing::HasSubstr, testing::IsEmpty, testing::IsNan, testing::IsSupersetOf, testing::Not,
    testing::Pointwise;
using testing::SizeIs, testing::StartsWith, testing::ThrowsMessage, testing::UnorderedElementsAre;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Matches a call that throws InputError, or another type, with a message that contains all of these: file and
// line, item or option.
template <class Refusal = InputError, class... Named>
auto Refuses(const Named&... named) {
  return ThrowsMessage<Refusal>(AllOf(HasSubstr(named)...));
}

}  // namespace salbench
