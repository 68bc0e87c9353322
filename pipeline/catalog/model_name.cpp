// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/catalog/model_name.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "pipeline/catalog/models.h"

namespace salbench {
namespace {

// In the tables and in the cache the name stands beside others: these mean something else there.
constexpr std::array<std::string_view, 3> kTaken = {"GS", "Avg", kConstantMap};
constexpr std::size_t kLongestName = 40;

}  // namespace

std::string wrong_with_model_name(std::string_view name) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  };
  if (name.empty() || name.size() > kLongestName || !std::all_of(name.begin(), name.end(), plain))
    return fmt::format("must be 1 to {} letters, digits, '-' and '_'", kLongestName);
  const auto rows = model_rows();
  if (std::find(kTaken.begin(), kTaken.end(), name) != kTaken.end() ||
      std::any_of(rows.begin(), rows.end(), [&](const ModelRow& row) { return row.name == name; }))
    return "is the name of something else in the tables; choose another";
  return {};
}

}  // namespace salbench
