// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/ground_truth_file.h"

#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "io/mat_file.h"
#include "io/number_table.h"
#include "io/text_scanner.h"
#include "io/values_file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

void expect_end_of_line(TextScanner& in) {
  if (!in.peek_word().empty()) in.fail("the line has more than one value");
}

ScalarField all_values(TextScanner& in) {
  ScalarField values;
  while (in.next_filled_line()) {
    values.push_back(in.number());
    expect_end_of_line(in);
  }
  return values;
}

TruthValues with_points(const std::vector<ScalarField>& columns) {
  TruthValues truth{columns[0], {}};
  for (std::size_t i = 0; i < truth.values.size(); ++i)
    truth.points.emplace_back(columns[1][i], columns[2][i], columns[3][i]);
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

}  // namespace

ScalarField parse_values(std::string_view text, std::string_view name) {
  TextScanner in(text, name);
  return all_values(in);
}

ScalarField parse_saliency(std::string_view text, std::string_view name, std::size_t n_vertices) {
  TextScanner in(text, name);
  ScalarField values = all_values(in);
  if (values.size() != n_vertices)
    in.fail(fmt::format("the file has {} values, but the mesh has {} vertices", values.size(), n_vertices));
  return values;
}

std::vector<std::int32_t> parse_picks(std::string_view text, std::string_view name, std::size_t n_vertices,
                                      std::int32_t base) {
  TextScanner in(text, name);
  std::vector<std::int32_t> picks;
  while (in.next_filled_line()) {
    const std::int64_t vertex = in.integer();
    if (vertex < base || vertex - base >= static_cast<std::int64_t>(n_vertices))
      in.fail(fmt::format("vertex {} is out of range: the mesh has {} vertices, numbered from {}", vertex,
                          n_vertices, base));
    picks.push_back(static_cast<std::int32_t>(vertex - base));
    expect_end_of_line(in);
  }
  return picks;
}

TruthValues parse_truth_values(std::string_view bytes, std::string_view name, const ValuesFormat& format,
                               std::size_t n) {
  const std::string_view noun = format.per == ValuePer::face ? "faces" : "vertices";
  if (format.per == ValuePer::point) {
    std::vector<std::string> columns = {format.column};
    columns.insert(columns.end(), format.points.begin(), format.points.end());
    return with_points(parse_columns(bytes, name, columns, format.unseen));
  }
  if (!is_npy(bytes) && !is_mat(bytes))
    return {parse_columns(bytes, name, {format.column}, format.unseen, {{n, noun}})[0], {}};
  ScalarField values = is_npy(bytes) ? parse_npy(bytes, name) : parse_mat(bytes, name, format.variable);
  mask_unseen(values, name, format.unseen);
  if (values.size() != n)
    throw InputError(
        fmt::format("{}: the file has {} values, but the mesh has {} {}", name, values.size(), n, noun));
  return {std::move(values), {}};
}

std::vector<std::int32_t> parse_truth_picks(std::string_view bytes, std::string_view name,
                                            const IndicesFormat& format, std::size_t n_vertices) {
  if (!is_mat(bytes)) return parse_picks(bytes, name, n_vertices, format.base);
  std::vector<std::int32_t> picks;
  for (const double vertex : parse_mat(bytes, name, format.variable, format.cell)) {
    if (!(vertex >= format.base && vertex - format.base < static_cast<double>(n_vertices)) ||
        vertex != std::floor(vertex))
      throw InputError(
          fmt::format("{}: {}: pick {} (from 1) is {}: the mesh has {} vertices, numbered from {}", name,
                      format.variable, picks.size() + 1, vertex, n_vertices, format.base));
    picks.push_back(static_cast<std::int32_t>(vertex) - format.base);
  }
  return picks;
}

}  // namespace salbench
