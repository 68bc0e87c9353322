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

using Cell = std::variant<std::string, std::int64_t, double>;  // NaN: not known

inline Cell cell_of(std::size_t count) { return static_cast<std::int64_t>(count); }

struct Table {
  std::vector<std::string> columns;     // names
  std::vector<std::vector<Cell>> rows;  // each as long as columns
  // For tables read from a file only:
  std::string name = {};                  // the file, for messages
  std::vector<std::size_t> lines = {};    // the line on which each row begins
  std::vector<std::string> remarks = {};  // lines above the column names, each after its '#'
};

// Doubles in the fewest digits that read back to the same value; NaN is empty.
std::string csv_text(const Cell& cell);

// Lines end in '\n'; fields are quoted where they must be.
std::string to_csv(const Table& table);

// Adds a row to such a text.
void append_csv_line(std::string& csv, const std::vector<Cell>& cells);

// The first line names the columns, after any lines that begin with '#'; every cell is read as text. Throws
// InputError, one line "PATH:LINE: what is wrong", for a line with another number of fields, a quote that
// does not close, or a column named twice.
Table read_csv(const std::filesystem::path& path);
Table parse_csv(std::string_view text, std::string_view name);

// One column. Throws InputError naming the columns there are, or the line of a cell that is not a number. An
// empty cell is NaN.
std::vector<double> number_column(const Table& table, std::string_view column);

// For the console: columns two spaces apart, numbers right-aligned with `decimals` decimals, "-" for NaN.
std::string aligned(const Table& table, int decimals = 4);

}  // namespace salbench
