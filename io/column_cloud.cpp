// SPDX-License-Identifier: GPL-3.0-or-later
// Point clouds in columns of a text, as studies of eye tracking publish them with their ground truth.
#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <span>

#include "io/cloud_file.h"
#include "io/file.h"
#include "io/mesh_parts.h"
#include "io/number_table.h"

namespace salbench {
namespace {

using CloudColumns = std::vector<ScalarField>;

bool is_zero_row(const CloudColumns& columns, std::size_t row) {
  return std::ranges::all_of(columns, [&](const ScalarField& column) { return column[row] == 0; });
}

std::vector<double> cloud_row(const CloudColumns& columns, std::size_t row) {
  std::vector<double> values;
  for (const ScalarField& column : columns) values.push_back(column[row]);
  return values;
}

// Number of the rows before the padding.
std::size_t rows_before_padding(const CloudColumns& columns, Padding padding) {
  const bool zeros = padding == Padding::zeros || padding == Padding::any;
  const bool copies = padding == Padding::copies || padding == Padding::any;
  std::size_t n = columns[0].size();
  std::vector<bool> is_copy(n, false);
  std::set<std::vector<double>> rows;
  for (std::size_t row = 0; copies && row < n; ++row)
    is_copy[row] = !rows.insert(cloud_row(columns, row)).second;
  while (n > 0 && (is_copy[n - 1] || (zeros && is_zero_row(columns, n - 1)))) --n;
  return n;
}

std::string_view wrong_with_normal(const Vec3& normal) {
  constexpr double kShortest = 0.5, kLongest = 2;
  const double length = normal.stableNorm();
  return length > 0 && (length < kShortest || length > kLongest)
             ? "the normal is not of unit length: name its columns, or add `normalise_normals: true`"
             : "";
}

}  // namespace

bool is_column_cloud(const std::filesystem::path& path, const ColumnsFormat& format) {
  const std::string extension = lower_case_extension(path);
  return format.given() && (extension == ".txt" || extension == ".csv");
}

PointCloud parse_column_cloud(std::string_view text, std::string_view name, const ColumnsFormat& format) {
  std::vector<std::string> columns = format.position;
  columns.insert(columns.end(), format.normal.begin(), format.normal.end());
  for (const std::string& column : {format.density, format.flag})
    if (!column.empty()) columns.push_back(column);
  const auto wrong = [&](std::span<const double> row) -> std::string_view {
    if (const std::string_view what = wrong_with_point({row[0], row[1], row[2]}); !what.empty()) return what;
    return format.normal.empty() || format.normalise_normals ? ""
                                                             : wrong_with_normal({row[3], row[4], row[5]});
  };
  const CloudColumns values = parse_columns(text, name, columns, {}, {}, wrong);
  const std::size_t n = values[0].size(), filled = rows_before_padding(values, format.padding);
  constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
  PointCloud cloud;
  std::set<std::array<double, 3>> places;
  for (std::size_t i = 0; i < n; ++i) {
    const std::array<double, 3> place = {values[0][i], values[1][i], values[2][i]};
    const bool left_out =
        i >= filled || (format.duplicates == Duplicates::dropped && !places.insert(place).second);
    cloud.points.push_back(left_out ? Vec3(kNowhere, kNowhere, kNowhere)
                                    : Vec3(place[0], place[1], place[2]));
    if (!format.normal.empty()) cloud.normals.emplace_back(values[3][i], values[4][i], values[5][i]);
  }
  return cloud;
}

ColumnTruth parse_column_truth(std::string_view text, std::string_view name, const ColumnsFormat& format) {
  ColumnTruth truth;
  if (!format.density.empty()) truth.saliency = parse_columns(text, name, {format.density})[0];
  if (format.flag.empty()) return truth;
  const ScalarField flags =
      parse_columns(text, name, {format.flag}, {}, {}, [](std::span<const double> row) -> std::string_view {
        return row[0] == 0 || row[0] == 1 ? "" : "the flag is neither 0 nor 1: name the column of the flag";
      })[0];
  for (std::size_t i = 0; i < flags.size(); ++i)
    if (flags[i] == 1) truth.picks.push_back(static_cast<std::int32_t>(i));
  return truth;
}

}  // namespace salbench
