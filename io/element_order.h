// SPDX-License-Identifier: GPL-3.0-or-later
// The column of a table that numbers the elements of a shape, and rows in the order of these numbers.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "io/number_table.h"
#include "io/text_scanner.h"

namespace salbench {

// Place of the column whose name says that it numbers the elements, among those that are not `taken`: one
// named after the elements ("vertex", "Point ID", "face_index"), else "index", "idx", "id" or "nr", else a
// first column without a name, as pandas and R write it. Throws InputError if two are equally good.
std::optional<std::size_t> numbering_column(const TextScanner& in, std::span<const std::string_view> header,
                                            const Elements& elements, std::span<const std::size_t> taken);

// The row of each element, [element], from the number that each row has: 0 to n - 1 or 1 to n, each once; the
// smallest number tells which. `lines` has the line of each row. Throws InputError for any other numbers.
std::vector<std::size_t> rows_in_order(const TextScanner& in, std::string_view column,
                                       std::span<const double> numbers, std::span<const std::size_t> lines,
                                       const Elements& elements);

}  // namespace salbench
