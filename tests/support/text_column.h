// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "io/table.h"

namespace salbench {

// Throws std::out_of_range if there is none of this name.
inline std::vector<std::string> text_column(const Table& table, std::string_view column) {
  const auto index =
      static_cast<std::size_t>(std::ranges::find(table.columns, column) - table.columns.begin());
  std::vector<std::string> texts;
  for (const std::vector<Cell>& row : table.rows) texts.push_back(csv_text(row.at(index)));
  return texts;
}

}  // namespace salbench
