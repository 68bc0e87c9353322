// SPDX-License-Identifier: GPL-3.0-or-later
// Location of the real data. Tests that need it skip with a message only if it is absent:
//   const auto data = real_data(); if (!data) GTEST_SKIP() << kNoRealData;
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>

namespace salbench {

inline constexpr const char* kNoRealData =
    "the real data is not here: set SALBENCH_DATA to a folder with SchellingData/ and reference/";

// Folder with SchellingData/, eyetracking/ and reference/.
inline std::optional<std::filesystem::path> real_data() {
  const char* folder = std::getenv("SALBENCH_DATA");
  if (folder == nullptr || !std::filesystem::exists(std::filesystem::path(folder) / "SchellingData"))
    return {};
  return folder;
}

}  // namespace salbench
