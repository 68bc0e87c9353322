// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>

#include <fmt/format.h>

#include "io/file.h"
#include "io/shapes/text_scanner.h"
#include "stages/core/check.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr std::string_view kBetweenRemarks = " | ";

std::string shortest(double value) {
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return std::string(digits.data(), end);
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return text;
  std::string escaped = "\"";
  for (const char c : text) escaped.append(c == '"' ? 2 : 1, c);
  return escaped + '"';
}

void add_remark(std::vector<std::string>& remarks, std::string remark) {
  if (std::ranges::find(remarks, remark) == remarks.end()) remarks.push_back(std::move(remark));
}

// Iterates over the fields of a CSV text and counts lines.
class CsvReader {
 public:
  CsvReader(std::string_view text, std::string_view name)
      : text_(without_byte_order_mark(text)), name_(name) {}

  // Leading lines that begin with '#', which may contain commas and quotes.
  std::vector<std::string> remarks() {
    std::vector<std::string> remarks;
    for (skip_blank_lines(); text_.starts_with('#'); skip_blank_lines()) {
      const std::string_view line = text_.substr(0, text_.find_first_of("\r\n"));
      text_.remove_prefix(line.size());
      add_remark(remarks, std::string(line.substr(std::min(line.find_first_not_of("# \t"), line.size()))));
    }
    return remarks;
  }

  // Fields of the next non-blank line; nullopt at the end.
  std::optional<std::vector<std::string>> next_row() {
    skip_blank_lines();
    if (text_.empty()) return {};
    row_line_ = line_;
    std::vector<std::string> fields = {field()};
    while (text_.starts_with(',')) {
      text_.remove_prefix(1);
      fields.push_back(field());
    }
    if (!text_.empty() && !skip_line_end()) fail(line_, "there is text after the quote that closes a field");
    return fields;
  }

  std::size_t row_line() const { return row_line_; }

  [[noreturn]] void fail(std::size_t line, std::string_view what) const {
    throw InputError(fmt::format("{}:{}: {}", name_, line, what));
  }

 private:
  void skip_blank_lines() {
    while (skip_line_end()) {
    }
  }

  bool skip_line_end() {
    const std::size_t length =
        text_.starts_with("\r\n") ? 2 : text_.starts_with('\n') || text_.starts_with('\r');
    text_.remove_prefix(length);
    line_ += length > 0;
    return length > 0;
  }

  std::string field() {
    if (text_.starts_with('"')) return quoted_field();
    const std::string_view field = text_.substr(0, text_.find_first_of(",\r\n"));
    text_.remove_prefix(field.size());
    return std::string(field);
  }

  std::string quoted_field() {
    const std::size_t opened = line_;
    std::string field;
    while (true) {
      text_.remove_prefix(1);  // the quote
      const std::size_t length = text_.find('"');
      if (length == text_.npos) fail(opened, "a quote opens a field that nothing closes");
      field += text_.substr(0, length);
      line_ += static_cast<std::size_t>(
          std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(length), '\n'));
      text_.remove_prefix(length + 1);
      if (!text_.starts_with('"')) return field;
      field += '"';  // a doubled quote
    }
  }

  std::string_view text_;  // not yet read
  std::string name_;
  std::size_t line_ = 1;
  std::size_t row_line_ = 1;
};

// Inverse of joined_remarks.
void add_remarks(std::vector<std::string>& remarks, std::string_view joined) {
  while (true) {
    const std::size_t end = joined.find(kBetweenRemarks);
    std::string remark(joined.substr(0, end));
    for (std::size_t bar = 0; (bar = remark.find("||", bar)) != remark.npos; ++bar) remark.erase(bar, 1);
    if (!remark.empty()) add_remark(remarks, std::move(remark));
    if (end == joined.npos) return;
    joined.remove_prefix(end + kBetweenRemarks.size());
  }
}

// Moves the remarks out of their column, and removes the column.
void take_remarks(Table& table) {
  const auto found = std::ranges::find(table.columns, kRemarks);
  if (found == table.columns.end()) return;
  const auto column = found - table.columns.begin();
  table.columns.erase(found);
  std::string last;
  for (std::vector<Cell>& row : table.rows) {
    auto& joined = std::get<std::string>(row[static_cast<std::size_t>(column)]);
    if (joined != last) add_remarks(table.remarks, last = std::move(joined));
    row.erase(row.begin() + column);
  }
}

std::string console_cell(const Cell& cell, int decimals) {
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  if (const auto* count = std::get_if<std::int64_t>(&cell)) return std::to_string(*count);
  const double value = std::get<double>(cell);
  if (std::isnan(value)) return "-";
  // A value that would be rounded to zero is printed with an exponent.
  const bool vanishes = value != 0 && std::abs(value) < 0.5 * std::pow(10.0, -decimals);
  return vanishes ? fmt::format("{:.1e}", value) : fmt::format("{:.{}f}", value, decimals);
}

// Display width of a UTF-8 text: its number of code points.
std::size_t width_of(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & '\xc0') != '\x80'; }));
}

struct ConsoleColumn {
  std::vector<std::string> cells;  // name, then values
  std::size_t width = 0;
  bool to_the_right = true;
};

ConsoleColumn console_column(const Table& table, std::size_t index, int decimals) {
  ConsoleColumn column;
  column.cells.push_back(table.columns[index]);
  for (const auto& row : table.rows) {
    CHECK_EQ(row.size(), table.columns.size());
    column.cells.push_back(console_cell(row[index], decimals));
    if (std::holds_alternative<std::string>(row[index])) column.to_the_right = false;
  }
  for (const std::string& cell : column.cells) column.width = std::max(column.width, width_of(cell));
  return column;
}

}  // namespace

std::string csv_text(const Cell& cell) {
  if (const auto* number = std::get_if<double>(&cell)) return std::isnan(*number) ? "" : shortest(*number);
  if (const auto* count = std::get_if<std::int64_t>(&cell)) return std::to_string(*count);
  return std::get<std::string>(cell);
}

void append_csv_line(std::string& csv, const std::vector<Cell>& cells) {
  const std::size_t begin = csv.size();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0) csv += ',';
    csv += csv_field(csv_text(cells[i]));
  }
  if (csv.size() == begin) csv += "\"\"";  // a blank line would not be read as a row
  csv += '\n';
}

std::string joined_remarks(const std::vector<std::string>& remarks) {
  std::string joined;
  for (const std::string& remark : remarks) {
    if (!joined.empty()) joined += kBetweenRemarks;
    for (const char c : remark) joined.append(c == '|' ? 2 : 1, c);
  }
  return joined;
}

std::string to_csv(const Table& table) {
  std::string csv;
  const auto append = [&](std::vector<Cell> cells, const std::string& remark) {
    if (!table.remarks.empty()) cells.emplace_back(remark);
    append_csv_line(csv, cells);
  };
  append({table.columns.begin(), table.columns.end()}, kRemarks);
  const std::string remarks = joined_remarks(table.remarks);
  for (const auto& row : table.rows) {
    CHECK_EQ(row.size(), table.columns.size());
    append(row, remarks);
  }
  return csv;
}

Table parse_csv(std::string_view text, std::string_view name) {
  CsvReader reader(text, name);
  Table table;
  table.name = name;
  table.remarks = reader.remarks();
  auto header = reader.next_row();
  if (!header)
    throw InputError(fmt::format("{}: the file is empty, where a line of column names is expected", name));
  table.columns = std::move(*header);
  std::vector<std::string> sorted = table.columns;
  std::ranges::sort(sorted);
  if (const auto twin = std::ranges::adjacent_find(sorted); twin != sorted.end())
    reader.fail(reader.row_line(), fmt::format("two columns are named {}", in_quotes(*twin)));
  while (auto fields = reader.next_row()) {
    if (fields->size() != table.columns.size())
      reader.fail(reader.row_line(),
                  fmt::format("the line has {} fields, the header {}", fields->size(), table.columns.size()));
    table.rows.emplace_back(std::make_move_iterator(fields->begin()), std::make_move_iterator(fields->end()));
    table.lines.push_back(reader.row_line());
  }
  take_remarks(table);
  return table;
}

Table read_csv(const std::filesystem::path& path) {
  // A histogram has a hundred rows, the index of a million shapes 100 MB. Larger files are no tables.
  constexpr std::uintmax_t kMaxBytes = 1U << 30U;
  std::error_code no_size;  // for a pipe, for example, which read_file refuses
  if (const auto size = std::filesystem::file_size(path, no_size); !no_size && size > kMaxBytes)
    throw InputError(
        fmt::format("{}: {} bytes, expected a table of at most {}", path.string(), size, kMaxBytes));
  return parse_csv(read_file(path), path.string());
}

std::string aligned(const Table& table, int decimals) {
  std::vector<ConsoleColumn> columns;
  for (std::size_t i = 0; i < table.columns.size(); ++i)
    columns.push_back(console_column(table, i, decimals));
  std::string text;
  for (std::size_t row = 0; row <= table.rows.size(); ++row) {
    std::string line;
    for (const ConsoleColumn& column : columns) {
      const std::string& cell = column.cells[row];
      const std::string padding(column.width - width_of(cell), ' ');
      line += column.to_the_right ? padding + cell : cell + padding;
      line += "  ";
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
  }
  return text;
}

}  // namespace salbench
