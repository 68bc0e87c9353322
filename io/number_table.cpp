// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/number_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "io/element_order.h"
#include "io/text_scanner.h"

namespace salbench {
namespace {

constexpr char kBlanks = ' ';
constexpr std::size_t kMostNamed = 20;  // columns in a message

struct Number {
  double value = 0;
  bool fits = true;  // a double; if not, there is no value
};

std::optional<Number> number_in(std::string_view word) {
  word = without_plus(word);
  Number number;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number.value);
  if (error == std::errc::invalid_argument || end != word.data() + word.size()) return {};
  number.fits = error != std::errc::result_out_of_range;
  return number;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kAround = " \t\r\"";
  text.remove_prefix(std::min(text.find_first_not_of(kAround), text.size()));
  return text.substr(0, text.find_last_not_of(kAround) + 1);
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  if (separator == kBlanks) {
    constexpr std::string_view kAny = " \t\r\v\f";
    for (std::size_t begin = line.find_first_not_of(kAny); begin != std::string_view::npos;) {
      const std::size_t end = std::min(line.find_first_of(kAny, begin), line.size());
      cells.push_back(trimmed(line.substr(begin, end - begin)));
      begin = line.find_first_not_of(kAny, end);
    }
    return cells;
  }
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    cells.push_back(trimmed(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  return cells;
}

// True of "0,5;1" for semicolons: numbers, with a comma within one of them at least.
bool separates_decimal_commas(char separator, std::string_view line) {
  const std::vector<std::string_view> cells = cells_of(line, separator);
  const auto has_comma = [](std::string_view cell) { return !decimal_comma_in(cell).empty(); };
  return cells.size() > 1 && std::any_of(cells.begin(), cells.end(), has_comma) &&
         std::all_of(cells.begin(), cells.end(),
                     [&](std::string_view cell) { return is_number(cell) || has_comma(cell); });
}

char separator_of(std::string_view line) {
  if (is_number(trimmed(line))) return kBlanks;
  for (const char separator : {';', '\t', kBlanks})
    if (separates_decimal_commas(separator, line)) return separator;
  for (const char separator : {',', ';', '\t'})
    if (line.find(separator) != std::string_view::npos) return separator;
  return kBlanks;
}

std::size_t count_filled(const std::vector<std::string_view>& cells) {  // without empty ones at the end
  std::size_t n = cells.size();
  while (n > 0 && cells[n - 1].empty()) --n;
  return n;
}

// True of the two cells of "0,5".
bool is_one_number(const std::vector<std::string_view>& cells) {
  return cells.size() == 2 && !decimal_comma_in(fmt::format("{},{}", cells[0], cells[1])).empty();
}

// "0,05" as two cells: whole numbers, of which one but the first has zeros in front.
bool look_like_decimal_commas(const std::vector<std::string_view>& cells) {
  const auto is_whole = [](std::string_view cell) {
    if (!cell.empty() && (cell[0] == '-' || cell[0] == '+')) cell.remove_prefix(1);
    return !cell.empty() && is_digits(cell);
  };
  return std::all_of(cells.begin(), cells.end(), is_whole) &&
         std::any_of(cells.begin() + 1, cells.end(),
                     [](std::string_view cell) { return cell.size() > 1 && cell[0] == '0'; });
}

// Number from 1 of a column without a header; 0 for a name.
std::size_t column_number(const std::string& column) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(column.data(), column.data() + column.size(), number);
  return error == std::errc() && end == column.data() + column.size() ? number : 0;
}

bool are_names(const std::vector<std::string_view>& cells) {
  return std::any_of(cells.begin(), cells.end(), [](std::string_view word) {
    return !word.empty() && !is_number(word) && decimal_comma_in(word).empty();
  });
}

// Skips to the next line with a word that is no comment. Comments are kept without their '#'.
bool next_row(TextScanner& in, std::vector<std::string_view>& comments) {
  while (in.next_filled_line()) {
    if (!in.peek_word().starts_with('#')) return true;
    comments.push_back(in.line().substr(in.line().find('#') + 1));
  }
  return false;
}

// The first line, or the last comment above it that has a name per column; empty if neither has names.
std::vector<std::string_view> header_of(const std::vector<std::string_view>& first,
                                        std::span<const std::string_view> comments, char separator) {
  if (are_names(first)) return first;
  for (auto comment = comments.rbegin(); comment != comments.rend(); ++comment)
    if (auto names = cells_of(*comment, separator); names.size() == first.size() && are_names(names))
      return names;
  return {};
}

// The cells of a line that the columns name.
class Columns {
 public:
  Columns(const TextScanner& in, const std::vector<std::string>& names,
          const std::vector<std::string_view>& first, const std::vector<std::string_view>& header,
          const std::optional<Elements>& elements)
      : names_(names), size_(first.size()), filled_(count_filled(first)), has_header_(!header.empty()) {
    for (const std::string& name : names) places_.push_back(place_of(in, name, header));
    by_name_ = std::ranges::any_of(names, [](const std::string& name) { return column_number(name) == 0; });
    if (elements) find_numbering(in, header, *elements);
  }

  // Of the column that numbers the rows; nothing if there is none.
  const std::optional<std::string>& numbering() const { return numbering_; }

  // Throws if the names of the header may stand above other columns, as R writes names of rows.
  void check_header(const TextScanner& in, const std::vector<std::string_view>& cells) const {
    if (has_header_ && (by_name_ || numbering_) && count_filled(cells) > size_)
      in.fail(fmt::format("{} columns, but the header names {}", count_filled(cells), size_));
  }

  // Throws where a comma that separates is likely to be a decimal one.
  void check_commas(const TextScanner& in, const std::vector<std::string_view>& cells) const {
    constexpr std::string_view kAdvice = "write decimal commas, if these are some, as points";
    const std::size_t filled = count_filled(cells);
    if (has_header_ ? filled > size_ : cells.size() != size_ && filled != filled_)
      in.fail(fmt::format("{} columns between commas, but the first line has {}: {}", cells.size(), size_,
                          kAdvice));
    if (!has_header_ && look_like_decimal_commas(cells))
      in.fail(
          fmt::format("whole numbers between commas, some with zeros in front: {}, or name the columns in a "
                      "first line",
                      kAdvice));
  }

  std::string_view numbering_cell(const TextScanner& in, const std::vector<std::string_view>& cells) const {
    if (numbering_place_ >= cells.size())
      in.fail(fmt::format("the line has no column {}", in_quotes(*numbering_)));
    return cells[numbering_place_];
  }

  std::string_view cell(const TextScanner& in, const std::vector<std::string_view>& cells,
                        std::size_t c) const {
    if (names_[c].empty() && cells.size() > (numbering_ ? 2U : 1U))
      in.fail(
          fmt::format("the line has {} columns, expected one value: keep that column alone, or, of ground "
                      "truth, name it in the description (`column:`){}",
                      cells.size(), is_one_number(cells) ? ", or write its decimal comma as a point" : ""));
    if (places_[c] >= cells.size())
      in.fail(fmt::format("the line has {} {}, expected column {}", cells.size(),
                          cells.size() == 1 ? "column" : "columns", described(c)));
    return cells[places_[c]];
  }

 private:
  // Beside the only column, one that numbers the rows is no other.
  void find_numbering(const TextScanner& in, const std::vector<std::string_view>& header,
                      const Elements& elements) {
    const bool only = names_.size() == 1 && names_[0].empty();
    if (only && header.size() != 2) return;
    const auto place = numbering_column(in, header, elements, only ? std::vector<std::size_t>{} : places_);
    if (!place) return;
    numbering_ = header[*place];
    numbering_place_ = *place;
    if (only) places_ = {1 - *place};
  }

  std::string described(std::size_t c) const {
    return column_number(names_[c]) > 0 ? names_[c] : in_quotes(names_[c]);
  }

  std::size_t place_of(const TextScanner& in, const std::string& name,
                       const std::vector<std::string_view>& header) const {
    if (name.empty()) return 0;
    if (const std::size_t number = column_number(name); number > 0) return number - 1;
    if (!has_header_)
      in.fail(fmt::format("no column {}: the first line has numbers, not names of columns", in_quotes(name)));
    const auto found = std::find(header.begin(), header.end(), name);
    if (found != header.end()) return static_cast<std::size_t>(found - header.begin());
    std::string known;
    for (std::size_t i = 0; i < std::min(header.size(), kMostNamed); ++i)
      known += (known.empty() ? "" : ", ") + in_quotes(header[i]);
    if (header.size() > kMostNamed) known += ", ...";
    in.fail(fmt::format("no column {}: the header has {}", in_quotes(name), known));
  }

  const std::vector<std::string>& names_;
  std::vector<std::size_t> places_;
  std::size_t size_, filled_;  // cells of the first line; without empty ones at its end
  bool has_header_, by_name_ = false;
  std::optional<std::string> numbering_ = {};
  std::size_t numbering_place_ = 0;
};

double value_of(const TextScanner& in, std::string_view cell, std::string_view unseen) {
  const std::optional<Number> number = number_in(cell);
  if (!number) in.fail(fmt::format("{} is not a number{}", in_quotes(cell), decimal_comma_in(cell)));
  if (!number->fits) in.fail(fmt::format("{} does not fit a double", in_quotes(cell)));
  if (is_same_number(number->value, unseen)) return std::numeric_limits<double>::quiet_NaN();
  if (!std::isfinite(number->value)) in.fail(fmt::format("{} is not a finite number", in_quotes(cell)));
  return number->value;
}

ScalarField in_order(const ScalarField& values, std::span<const std::size_t> row_of) {
  ScalarField ordered;
  for (const std::size_t row : row_of) ordered.push_back(values[row]);
  return ordered;
}

}  // namespace

std::string wrong_count(std::size_t n_values, const Elements& expected) {
  return fmt::format("the file has {} values, but the {} has {} {}", n_values, expected.shape, expected.n,
                     expected.plural);
}

bool is_number(std::string_view word) { return number_in(word).has_value(); }

bool is_same_number(double value, std::string_view word) {
  const std::optional<Number> number = number_in(word);
  return number && number->fits &&
         (value == number->value || (std::isnan(value) && std::isnan(number->value)));
}

std::vector<ScalarField> parse_columns(std::string_view text, std::string_view name,
                                       const std::vector<std::string>& columns, const std::string& unseen,
                                       const std::optional<Elements>& expected,
                                       const WrongWithRow& wrong_with_row) {
  std::vector<ScalarField> values(columns.size());
  std::vector<double> row(columns.size()), numbers;
  std::vector<std::size_t> lines;
  std::optional<std::string> numbering;
  TextScanner in(text, name);
  std::vector<std::string_view> comments;
  if (next_row(in, comments)) {
    const char separator = separator_of(in.line());
    std::vector<std::string_view> cells = cells_of(in.line(), separator);
    const Columns chosen(in, columns, cells, header_of(cells, comments, separator), expected);
    numbering = chosen.numbering();
    for (bool more = !are_names(cells) || next_row(in, comments); more; more = next_row(in, comments)) {
      cells = cells_of(in.line(), separator);
      if (separator == ',') chosen.check_commas(in, cells);
      chosen.check_header(in, cells);
      for (std::size_t c = 0; c < columns.size(); ++c)
        row[c] = value_of(in, chosen.cell(in, cells, c), c == 0 ? unseen : std::string_view());
      const std::string_view wrong = wrong_with_row ? wrong_with_row(row) : std::string_view();
      if (!wrong.empty()) in.fail(wrong);
      for (std::size_t c = 0; c < columns.size(); ++c) values[c].push_back(row[c]);
      if (!numbering) continue;
      numbers.push_back(value_of(in, chosen.numbering_cell(in, cells), {}));
      lines.push_back(in.line_number());
    }
  }
  if (expected && expected->n != Elements::kUnknown && values[0].size() != expected->n)
    in.fail(wrong_count(values[0].size(), *expected));
  if (values[0].empty()) in.fail("the file has no values");
  if (!numbering) return values;
  const std::vector<std::size_t> row_of = rows_in_order(in, *numbering, numbers, lines, *expected);
  for (ScalarField& column : values) column = in_order(column, row_of);
  return values;
}

}  // namespace salbench
