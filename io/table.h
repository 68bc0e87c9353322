// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of numbers and text: CSV files (RFC 4180) and columns for the console.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace salbench {

using Cell = std::variant<std::string, std::int64_t, double>;  // NaN: unknown

inline Cell cell_of(std::size_t count) { return static_cast<std::int64_t>(count); }

struct Table {
  std::vector<std::string> columns;     // names
  std::vector<std::vector<Cell>> rows;  // each as long as columns
  // Only for tables read from a file:
  std::string name = {};                  // the file, for messages
  std::vector<std::size_t> lines = {};    // line on which each row begins
  std::vector<std::string> remarks = {};  // on the whole table, lines of text
};

// In a file, the remarks are in each row of a last column with this name: the first line remains the header,
// and copied rows keep their remarks.
inline constexpr const char* kRemarks = "remarks";

// Several remarks in one cell, separated by " | "; bars within a remark are doubled.
std::string joined_remarks(const std::vector<std::string>& remarks);

// Doubles with the fewest digits that read back to the same value; NaN is empty.
std::string csv_text(const Cell& cell);

// Lines end in '\n'; fields are quoted if necessary. With remarks, their column is the last.
std::string to_csv(const Table& table);

// Appends a row.
void append_csv_line(std::string& csv, const std::vector<Cell>& cells);

// The first line names the columns; every cell is read as text. Remarks come from their column, which is then
// removed, and from leading lines that begin with '#', as written by 1.0: each once, in order of appearance.
// Throws InputError, one line "PATH:LINE: problem", for a line with a wrong number of fields, an unclosed
// quote, or a duplicate column.
Table read_csv(const std::filesystem::path& path);
Table parse_csv(std::string_view text, std::string_view name);

// For the console: columns two spaces apart, numbers right-aligned with `decimals` decimals, "-" for NaN.
std::string aligned(const Table& table, int decimals = 4);

}  // namespace salbench
