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
  std::vector<std::string> remarks = {};  // on all of the table, lines of text
};

// In a file the remarks stand in each row of a last column of this name, so that the first line is the header
// and a row that is copied takes them along.
inline constexpr const char* kRemarks = "remarks";

// Several in one cell, with " | " between them: bars within one are doubled.
std::string joined_remarks(const std::vector<std::string>& remarks);

// Doubles in the fewest digits that read back to the same value; NaN is empty.
std::string csv_text(const Cell& cell);

// Lines end in '\n'; fields are quoted where they must be. Where there are remarks, their column is the last.
std::string to_csv(const Table& table);

// Adds a row to such a text.
void append_csv_line(std::string& csv, const std::vector<Cell>& cells);

// The first line names the columns; every cell is read as text. Remarks are those of their column, which is
// none of the table's, and of lines above the first that begin with '#', as 1.0 wrote them: each once, in the
// order in which they appear. Throws InputError, one line "PATH:LINE: what is wrong", for a line with another
// number of fields, a quote that does not close, or a column named twice.
Table read_csv(const std::filesystem::path& path);
Table parse_csv(std::string_view text, std::string_view name);

// For the console: columns two spaces apart, numbers right-aligned with `decimals` decimals, "-" for NaN.
std::string aligned(const Table& table, int decimals = 4);

}  // namespace salbench
