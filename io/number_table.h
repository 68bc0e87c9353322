// SPDX-License-Identifier: GPL-3.0-or-later
// Columns of a text of numbers, a row per line: CSV, or words between blanks.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

// The elements of a shape that a file has one value for each of: their number, and their names in messages.
struct Elements {
  static constexpr std::size_t kUnknown = std::numeric_limits<std::size_t>::max();
  std::size_t n = kUnknown;  // any number of rows will do, then
  std::string_view shape = "mesh", one = "vertex", plural = "vertices";
};

// Describes what is wrong with the numbers of one row; empty if nothing.
using WrongWithRow = std::function<std::string_view(std::span<const double> row)>;

// The columns named, each by its name in the header or by its number from 1, in the order of `columns`; an
// empty name is the only column of the text. Commas, semicolons or tabs separate values, whichever the first
// line has; else blanks do. A first line in which a word is no number is the header. Blank lines are skipped,
// and so are lines that begin with '#', of which the last before the numbers is a header if it has a word per
// column. Decimal commas are refused. Where commas are all that separates, they show in lines of other
// numbers of columns, or by zeros in front as in 0,05: a header tells such lines from whole numbers.
//
// With `expected`, rows come in the order of the elements: a column that numbers these (element_order.h) is
// obeyed, and is none beside which the only column would not be the only one.
//
// A value of the first column that is `unseen` ("nan" for one that is none) becomes NaN; all others must be
// finite. Throws InputError, one line "NAME:LINE: what is wrong": also for another number of rows than
// expected, or none, and for what is wrong with a row.
std::vector<ScalarField> parse_columns(std::string_view text, std::string_view name,
                                       const std::vector<std::string>& columns,
                                       const std::string& unseen = {},
                                       const std::optional<Elements>& expected = {},
                                       const WrongWithRow& wrong_with_row = {});

// "the file has 3 values, but the mesh has 4 vertices"
std::string wrong_count(std::size_t n_values, const Elements& expected);

bool is_number(std::string_view word);                     // also one that is not finite
bool is_same_number(double value, std::string_view word);  // NaN is the same as "nan"; none as no number

}  // namespace salbench
