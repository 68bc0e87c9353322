// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/ground_truth_file.h"

#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "io/mat_file.h"
#include "io/mesh_parts.h"
#include "io/text_scanner.h"
#include "io/values_file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

void expect_end_of_line(TextScanner& in) {
  if (!in.peek_word().empty()) in.fail("the line has more than one value");
}

// Rows of a value and the coordinates of its point.
TruthValues values_with_points(std::string_view text, std::string_view name, const ValuesFormat& format) {
  std::vector<std::string> names = {format.column};
  names.insert(names.end(), format.points.begin(), format.points.end());
  const std::vector<ScalarField> columns =
      parse_columns(text, name, names, format.unseen, {}, [&](std::span<const double> row) {
        return wrong_with_point(format.scale * Vec3(row[1], row[2], row[3]));
      });
  TruthValues truth{columns[0], {}};
  for (std::size_t i = 0; i < truth.values.size(); ++i)
    truth.points.emplace_back(format.scale * Vec3(columns[1][i], columns[2][i], columns[3][i]));
  return truth;
}

// A binary format has no lines: the message counts values.
void mask_unseen(ScalarField& values, std::string_view name, const std::string& unseen) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (is_same_number(values[i], unseen))
      values[i] = std::numeric_limits<double>::quiet_NaN();
    else if (!std::isfinite(values[i]))
      throw InputError(
          fmt::format("{}: value {} (0-based) is {}, expected a finite number", name, i, values[i]));
  }
}

std::string numbering(const Elements& elements, std::int32_t base) {
  return fmt::format("the {} has {} {}, numbered from {}", elements.shape, elements.n, elements.plural, base);
}

}  // namespace

ScalarField parse_values(std::string_view text, std::string_view name, const Elements& elements) {
  return parse_columns(text, name, {""}, {}, elements)[0];
}

std::vector<std::int32_t> parse_picks(std::string_view text, std::string_view name, const Elements& elements,
                                      std::int32_t base) {
  TextScanner in(text, name, '#');
  std::vector<std::int32_t> picks;
  while (in.next_filled_line()) {
    const std::int64_t index = in.integer();
    if (index < base || index - base >= static_cast<std::int64_t>(elements.n))
      in.fail(fmt::format("{} {} is out of range: {}", elements.one, index, numbering(elements, base)));
    picks.push_back(static_cast<std::int32_t>(index - base));
    expect_end_of_line(in);
  }
  return picks;
}

TruthValues parse_truth_values(std::string_view bytes, std::string_view name, const ValuesFormat& format,
                               const Elements& elements) {
  if (format.per == ValuePer::point) {
    if (is_npy(bytes) || is_mat(bytes))
      throw InputError(
          fmt::format("{}: values per point stand in columns beside x, y and z: write them as text", name));
    return values_with_points(bytes, name, format);
  }
  if (!is_npy(bytes) && !is_mat(bytes))
    return {parse_columns(bytes, name, {format.column}, format.unseen, elements)[0], {}};
  ScalarField values =
      is_npy(bytes) ? parse_npy(bytes, name) : parse_mat_values(bytes, name, format.variable);
  mask_unseen(values, name, format.unseen);
  if (values.size() != elements.n)
    throw InputError(fmt::format("{}: {}", name, wrong_count(values.size(), elements)));
  return {std::move(values), {}};
}

std::vector<std::int32_t> parse_truth_picks(std::string_view bytes, std::string_view name,
                                            const IndicesFormat& format, const Elements& elements) {
  if (!is_mat(bytes)) return parse_picks(bytes, name, elements, format.base);
  std::vector<std::int32_t> picks;
  for (const double index : parse_mat(bytes, name, format.variable, format.cell)) {
    if (!(index >= format.base && index - format.base < static_cast<double>(elements.n)) ||
        index != std::floor(index))
      throw InputError(fmt::format("{}: {}: pick {} (from 1) is {}: {}", name, format.variable,
                                   picks.size() + 1, index, numbering(elements, format.base)));
    picks.push_back(static_cast<std::int32_t>(index) - format.base);
  }
  return picks;
}

}  // namespace salbench
