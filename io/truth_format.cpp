// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/truth_format.h"

#include <algorithm>
#include <charconv>

#include "io/number_table.h"
#include "io/text_scanner.h"
#include "stages/core/errors.h"

namespace salbench {

void check(const ValuesFormat& format) {
  check_ranges(format);
  if (format.per == ValuePer::point && format.column.empty())
    throw OptionError("column", "is missing; values per point stand beside coordinates: expected a column");
  if (format.points.size() != 3) throw OptionError("points", "must be three columns, of x, y and z");
  if (!format.unseen.empty() && !is_number(format.unseen))
    throw OptionError("unseen", "is '" + format.unseen + "', not a number or nan");
  positive_rule(format);
}

PositiveRule positive_rule(const ValuesFormat& format) {
  constexpr std::string_view kTop = "top ", kAboveMean = "above mean";
  const std::string_view text = format.positives;
  if (text == kPositivesArePicks) return {};
  if (text == kAboveMean) return {PositiveRule::By::mean};
  if (text.starts_with(kTop) && text.ends_with('%')) {
    const std::string_view number = text.substr(kTop.size(), text.size() - kTop.size() - 1);
    double percent = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), percent);
    if (error == std::errc() && end == number.data() + number.size() && percent > 0 && percent < 100)
      return {PositiveRule::By::top, percent};
  }
  throw OptionError("positives",
                    "is '" + format.positives + "', not picks, above mean, or a share such as top 20%");
}

void check(const ColumnsFormat& format) {
  check_ranges(format);
  if (!format.given() && (format.has_truth() || !format.normal.empty()))
    throw OptionError("position", "is missing; expected the columns of x, y and z");
  if (format.given() && format.position.size() != 3)
    throw OptionError("position", "must be three columns, of x, y and z");
  if (!format.normal.empty() && format.normal.size() != 3)
    throw OptionError("normal", "must be three columns, of x, y and z");
}

void check(const IndicesFormat& format) {
  check_ranges(format);
  const auto is_place = [](const std::string& text) {
    return !text.empty() && text.size() < 7 && text[0] != '0' && is_digits(text);
  };
  if (!format.cell.empty() && (format.cell.size() != 2 || !std::ranges::all_of(format.cell, is_place)))
    throw OptionError("cell", "must be a row and a column, from 1, such as [3, 8]");
}

}  // namespace salbench
