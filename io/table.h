// Tables of numbers and text: CSV files (RFC 4180) and columns for the console.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace salbench {

using Cell = std::variant<std::string, std::int64_t, double>;  // NaN: nothing is known

inline Cell cell_of(std::size_t count) { return static_cast<std::int64_t>(count); }

struct Table {
  std::vector<std::string> columns;     // names
  std::vector<std::vector<Cell>> rows;  // each as long as columns
  std::string name = {};                // of the file it was read from, for messages
  std::vector<std::size_t> lines = {};  // of a table read from a file: the line on which each row begins
  std::string remark = {};              // and what stands above the names of its columns, after a '#'
};

// Lines end in '\n'; doubles in the fewest digits that read back to the same value; NaN is an empty field;
// fields are quoted where they must be.
std::string to_csv(const Table& table);

// The first line names the columns, but for lines above it that begin with '#' and have one field; every cell
// is read as text. Throws InputError, one line "PATH:LINE: what is wrong", for a line with another number of
// fields, a quote that does not close, or a column named twice.
Table read_csv(const std::filesystem::path& path);
Table parse_csv(std::string_view text, std::string_view name);

// One column; InputError names the columns there are, or the line of a cell that is not a number. An empty
// cell is NaN.
std::vector<double> number_column(const Table& table, std::string_view column);
std::vector<std::string> text_column(const Table& table, std::string_view column);

// For people: columns two spaces apart, numbers to the right with `decimals` digits behind the point, "-" for
// NaN.
std::string aligned(const Table& table, int decimals = 4);

}  // namespace salbench
