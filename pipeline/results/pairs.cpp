// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/pairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "pipeline/results/metric_rows.h"
#include "stages/stats/multiple.h"

namespace salbench {
namespace {

// A row per pair: its names, then its cells.
template <class Cells>
std::vector<std::vector<Cell>> pair_rows(const DatasetScores& scores, std::size_t metric,
                                         const std::string& name, const Cells& cells) {
  std::vector<std::vector<Cell>> rows;
  for (const ModelPair& pair : model_pairs(scores, metric)) {
    rows.push_back({scores.dataset(), name, scores.models()[pair.a], scores.models()[pair.b]});
    std::ranges::move(cells(pair), std::back_inserter(rows.back()));
  }
  return rows;
}

std::vector<Cell> significance_cells(const ModelPair& pair) {
  const PairedComparison& found = pair.by_unit;
  return {found.n,
          pair.n_shapes,
          found.mean_difference,
          found.interval.low,
          found.interval.high,
          found.t_p,
          found.equivalence_interval.low,
          found.equivalence_interval.high,
          found.d_z,
          found.rank_biserial,
          found.superiority,
          found.superiority_interval.low,
          found.superiority_interval.high,
          pair.by_shape.z,
          pair.by_shape.p_value,
          pair.signed_rank.statistic,
          pair.signed_rank.p_value,
          pair.holm};
}

std::vector<std::vector<Cell>> significance_rows(const DatasetScores& scores, std::size_t metric,
                                                 const std::string& name) {
  std::vector<std::vector<Cell>> rows = pair_rows(scores, metric, name, significance_cells);
  const auto n_tests = std::ranges::count_if(
      rows, [](const std::vector<Cell>& row) { return !std::isnan(std::get<double>(row.back())); });
  for (std::vector<Cell>& row : rows) row.emplace_back(static_cast<std::int64_t>(n_tests));
  return rows;
}

std::vector<Cell> power_cells(const ModelPair& pair) {
  const PairedComparison& found = pair.by_unit;
  const std::int64_t needed =
      found.deviation > 0 ? units_to_detect(found.mean_difference, found.deviation) : -1;
  return {found.n,
          pair.n_shapes,
          found.deviation,
          detectable_difference(found.deviation, found.n),
          found.mean_difference,
          needed > 0 ? Cell(needed) : Cell(std::string())};
}

}  // namespace

ModelPair compare_models(const DatasetScores& scores, std::size_t metric, std::size_t a, std::size_t b) {
  const std::array pair{a, b};
  const UnitScores both = scores.compared(metric, pair);
  const std::vector<double> of_a = both.scores.column(0), of_b = both.scores.column(1);
  return {.a = a,
          .b = b,
          .n_shapes = both.n_shapes,
          .by_unit = compare_paired(of_a, of_b),
          .signed_rank = signed_rank_test(of_a, of_b),
          .by_shape = rank_sum_test(scores.by_shape(metric, a), scores.by_shape(metric, b))};
}

std::vector<ModelPair> model_pairs(const DatasetScores& scores, std::size_t metric) {
  std::vector<ModelPair> pairs;
  const std::vector<std::size_t> models = scores.scored(metric);
  for (std::size_t i = 0; i < models.size(); ++i)
    for (std::size_t j = i + 1; j < models.size(); ++j)
      pairs.push_back(compare_models(scores, metric, models[i], models[j]));
  std::vector<double> p_values;
  for (const ModelPair& pair : pairs) p_values.push_back(pair.signed_rank.p_value);
  const std::vector<double> adjusted = holm_adjusted(p_values);
  for (std::size_t k = 0; k < pairs.size(); ++k) pairs[k].holm = adjusted[k];
  return pairs;
}

Table significance_table(const Conclusions& conclusions) {
  return rows_by_metric(
      conclusions,
      {"dataset",
       "metric",
       "model_a",
       "model_b",
       "n",
       "n_shapes",
       "mean_difference",
       "ci95_low",
       "ci95_high",
       "t_p",
       "ci90_low",
       "ci90_high",
       "d_z",
       "rank_biserial",
       "superiority",
       "superiority_low",
       "superiority_high",
       "rank_sum_z",
       "rank_sum_p",
       "signed_rank",
       "signed_rank_p",
       "signed_rank_p_holm",
       "n_tests"},
      [](const DatasetConclusions& dataset, const RankedMetric& ranked, const std::string& metric) {
        return significance_rows(dataset.scores, ranked.metric, metric);
      });
}

Table power_table(const Conclusions& conclusions) {
  return rows_by_metric(
      conclusions,
      {"dataset", "metric", "model_a", "model_b", "n", "n_shapes", "sd", "detectable", "mean_difference",
       "n_to_detect"},
      [](const DatasetConclusions& dataset, const RankedMetric& ranked, const std::string& metric) {
        return pair_rows(dataset.scores, ranked.metric, metric, power_cells);
      });
}

}  // namespace salbench
