// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of tables.
#pragma once

#include <type_traits>
#include <vector>

#include "io/table.h"

namespace salbench {

// The cells of texts, counts and numbers, and of the cells of others.
template <class... Values>
std::vector<Cell> cells(const Values&... values) {
  std::vector<Cell> row;
  row.reserve(2 * sizeof...(values));  // g++ 14 sees writes past the end in a vector that grows
  const auto add = [&]<class Value>(const Value& value) {
    if constexpr (std::is_same_v<Value, std::vector<Cell>>)
      row.insert(row.end(), value.begin(), value.end());
    else if constexpr (std::is_integral_v<Value>)
      row.emplace_back(static_cast<std::int64_t>(value));
    else
      row.emplace_back(value);
  };
  (add(values), ...);
  return row;
}

}  // namespace salbench
