// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "io/table.h"
#include "stages/core/number.h"

namespace salbench {

// Both throw std::out_of_range if there is no such column.
inline std::vector<std::string> text_column(const Table& table, std::string_view column) {
  const auto index =
      static_cast<std::size_t>(std::ranges::find(table.columns, column) - table.columns.begin());
  std::vector<std::string> texts;
  for (const std::vector<Cell>& row : table.rows) texts.push_back(csv_text(row.at(index)));
  return texts;
}

// An empty cell is NaN. Throws std::bad_optional_access for a cell that is not a number.
inline std::vector<double> number_column(const Table& table, std::string_view column) {
  std::vector<double> numbers;
  for (const std::string& text : text_column(table, column))
    numbers.push_back(text.empty() ? std::numeric_limits<double>::quiet_NaN()
                                   : number_in<double>(text).value());
  return numbers;
}

}  // namespace salbench
