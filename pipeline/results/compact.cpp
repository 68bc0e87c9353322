// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/compact.h"

#include <algorithm>
#include <cmath>

#include "pipeline/results/table_rows.h"
#include "stages/metrics/range.h"
#include "stages/stats/summary.h"

namespace salbench {
namespace {

// Shapes that some model has a score for and this one has not: [model].
std::vector<std::int64_t> missing_shapes(const DatasetScores& scores, std::size_t metric) {
  std::vector<std::vector<double>> values;
  for (std::size_t model = 0; model < scores.models().size(); ++model)
    values.push_back(scores.by_shape(metric, model));
  std::vector<std::int64_t> missing(values.size(), 0);
  for (std::size_t shape = 0; !values.empty() && shape < values[0].size(); ++shape) {
    const auto lacks = [&](const std::vector<double>& of_model) { return std::isnan(of_model[shape]); };
    if (std::ranges::all_of(values, lacks)) continue;
    for (std::size_t model = 0; model < values.size(); ++model)
      missing[model] += lacks(values[model]) ? 1 : 0;
  }
  return missing;
}

// Competitors by rank, then references.
std::vector<std::size_t> in_order(const DatasetScores& scores, const RankedMetric& ranked) {
  std::vector<std::size_t> models = scores.scored(ranked.metric);
  const auto place = [&](std::size_t model) {
    const std::size_t column = ranked.scores.column_of(model);
    const bool known = column < ranked.ranking.models.size() && ranked.ranking.models[column].rank > 0;
    return std::pair(scores.is_reference(model), known ? ranked.ranking.models[column].rank : 0);
  };
  std::ranges::stable_sort(models, {}, place);
  return models;
}

Rows compact_rows(const DatasetScores& scores, const RankedMetric& ranked, const Metric& metric) {
  const std::vector<std::int64_t> missing = missing_shapes(scores, ranked.metric);
  Rows rows;
  for (const std::size_t model : in_order(scores, ranked)) {
    const UnitScores compared = scores.compared(ranked.metric, {&model, 1});
    const Summary summary = summarise(compared.scores.values);
    const Interval whole = student_interval(summary), kept = interval_within_range(summary, metric.name);
    const bool cut = kept.low > whole.low || kept.high < whole.high;
    const std::size_t column = ranked.scores.column_of(model);
    const ModelRank rank =
        column < ranked.ranking.models.size() ? ranked.ranking.models[column] : ModelRank{};
    rows.push_back(cells(
        scores.label(), metric.name, metric.higher_is_better ? "higher" : "lower", scores.models()[model],
        scores.is_reference(model) ? "reference" : "model", summary.n, compared.n_shapes, missing[model],
        summary.mean, kept, cut ? std::numeric_limits<double>::quiet_NaN() : (whole.high - whole.low) / 2,
        rank.rank > 0 ? Cell(rank.rank) : Cell(std::string()), rank.letters, rank.rank == 1 ? 1 : 0));
  }
  return rows;
}

}  // namespace

Interval interval_within_range(const Summary& summary, const std::string& metric) {
  const Range range = range_of(metric);
  Interval interval = student_interval(summary);
  if (interval.low < range.low) interval.low = std::min(range.low, summary.mean);
  if (interval.high > range.high) interval.high = std::max(range.high, summary.mean);
  return interval;
}

Table compact_table(const Conclusions& conclusions) {
  return {
      .columns = conclusions.labelled({"dataset", "metric", "better", "model", "kind", "n", "n_shapes",
                                       "n_missing", "mean", "low", "high", "half", "rank", "group", "best"}),
      .rows = rows_by_metric(conclusions, compact_rows)};
}

}  // namespace salbench
