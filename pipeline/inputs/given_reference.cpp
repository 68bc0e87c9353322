// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/inputs/given_reference.h"

#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/table.h"
#include "stages/core/errors.h"

namespace salbench {

// Densities over [0, 1] sum to the number of their bins; a column that sums to anything else, such as
// probabilities, is of the same shape, and shape is what it stands for.
Histogram read_reference(const std::string& path) {
  constexpr double kRounded = 1e-3;  // of the sum: a density that was written with few digits
  const Table table = read_csv(path);
  const std::vector<double> column = number_column(table, "GS");
  Histogram histogram{};
  if (column.size() != histogram.size())
    throw ConfigError(
        fmt::format("{}: column GS has {} rows, expected {} bins", path, column.size(), histogram.size()));
  for (std::size_t i = 0; i < histogram.size(); ++i) {
    histogram[i] = column[i];
    if (!std::isfinite(column[i]) || column[i] < 0)
      throw ConfigError(fmt::format("{}:{}: column GS holds {}, expected a density, finite and not negative",
                                    path, table.lines[i], column[i]));
  }
  const double sum = std::accumulate(column.begin(), column.end(), 0.0);
  if (!(sum > 0) || !std::isfinite(sum))
    throw ConfigError(fmt::format("{}:{}: column GS sums to {:.6g} from here on: no density does", path,
                                  table.lines.front(), sum));
  for (const std::string& remark : table.remarks) spdlog::warn("{}: {}", path, remark);
  const auto bins = static_cast<double>(histogram.size());
  if (std::abs(sum / bins - 1) <= kRounded) return histogram;
  spdlog::warn("{}: column GS sums to {:.6g}, densities over {} bins to {}: it was scaled", path, sum, bins,
               bins);
  for (double& density : histogram) density = density / sum * bins;
  return histogram;
}

}  // namespace salbench
