// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/metrics.h"

#include <algorithm>

#include "stages/core/errors.h"

namespace salbench {
namespace {

// Versions of `scores` since which metrics may read unmatched maps, and maps outside of [0, 1] have no floor.
constexpr std::int32_t kUnmatchedSince = 3, kUnflooredSince = 5;

}  // namespace

std::vector<Metric> chosen_metrics(const MetricsOptions& options) {
  const std::span<const Metric> table = metric_table();
  for (const std::string& name : options.names)
    if (std::ranges::find(table, name, &Metric::name) == table.end())
      throw OptionError("names", "has no metric '" + name + "'");
  std::vector<Metric> chosen;
  for (const Metric& metric : table) {
    if (std::ranges::find(options.names, metric.name) == options.names.end()) continue;
    chosen.push_back(metric);
    Metric& added = chosen.back();
    if (const auto matching = options.matching.find(metric.name); matching != options.matching.end())
      added.matching = matching->second;
    if (options.floor != 0 && !is_normalised(added.matching))
      added.since = std::max(added.since, kUnflooredSince);
  }
  return chosen;
}

std::int32_t scores_version(std::span<const Metric> metrics) {
  std::int32_t version = 1;
  for (const Metric& metric : metrics)
    version = std::max({version, metric.since, metric.matching == Matching::histogram ? 1 : kUnmatchedSince});
  return version;
}

bool any_reads(std::span<const Metric> metrics, Reads what) {
  return std::ranges::find(metrics, what, &Metric::reads) != metrics.end();
}

bool any_of_points(std::span<const Metric> metrics) {
  return any_reads(metrics, Reads::positions) || any_reads(metrics, Reads::other_shapes) ||
         any_of_faces(metrics);
}

bool any_of_faces(std::span<const Metric> metrics) {
  return any_reads(metrics, Reads::areas) || any_reads(metrics, Reads::surface_distances);
}

}  // namespace salbench
