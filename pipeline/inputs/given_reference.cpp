// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/inputs/given_reference.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/table.h"
#include "stages/core/errors.h"
#include "stages/matching/matching.h"

namespace salbench {

Histogram read_reference(const std::string& path) {
  const Table table = read_csv(path);
  const std::vector<double> column = number_column(table, "GS");
  if (column.size() != kHistogramBins)
    throw ConfigError(
        fmt::format("{}: column GS has {} rows, expected {} bins", path, column.size(), kHistogramBins));
  const GivenDensity given =
      given_density(column, [&](std::optional<std::size_t> bin, const std::string& what) {
        throw ConfigError(bin ? fmt::format("{}:{}: column GS holds {}", path, table.lines[*bin], what)
                              : fmt::format("{}:{}: column GS {}", path, table.lines.front(), what));
      });
  for (const std::string& remark : table.remarks) spdlog::warn("{}: {}", path, remark);
  if (!given.remark.empty()) spdlog::warn("{}: column GS {}", path, given.remark);
  return given.density;
}

}  // namespace salbench
