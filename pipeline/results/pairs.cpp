// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/pairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "pipeline/results/table_rows.h"
#include "stages/stats/multiple.h"

namespace salbench {
namespace {

// A row per pair: its names, then its cells.
template <class Cells>
Rows pair_rows(const DatasetScores& scores, std::size_t metric, const std::string& name,
               const Cells& cells_of) {
  Rows rows;
  for (const ModelPair& pair : model_pairs(scores, metric))
    rows.push_back(cells(scores.label(), name, scores.models()[pair.a], scores.models()[pair.b],
                         pair.by_unit.n, pair.n_shapes, cells_of(pair, pair.by_unit)));
  return rows;
}

std::vector<Cell> significance_cells(const ModelPair& pair, const PairedComparison& found) {
  return cells(found.mean_difference, found.interval, found.t_p, found.equivalence_interval, found.d_z,
               found.rank_biserial, found.superiority, found.superiority_interval, pair.by_shape.z,
               pair.by_shape.p_value, pair.signed_rank.statistic, pair.signed_rank.p_value, pair.holm);
}

std::vector<Cell> power_cells(const ModelPair&, const PairedComparison& found) {
  const std::int64_t needed =
      found.deviation > 0 ? units_to_detect(found.mean_difference, found.deviation) : -1;
  return cells(found.deviation, detectable_difference(found.deviation, found.n), found.mean_difference,
               needed > 0 ? Cell(needed) : Cell(std::string()));
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
  const auto rows_of = [](const DatasetScores& scores, const RankedMetric& ranked, const Metric& metric) {
    Rows rows = pair_rows(scores, ranked.metric, metric.name, significance_cells);
    const auto n_tests = std::ranges::count_if(
        rows, [](const std::vector<Cell>& row) { return !std::isnan(std::get<double>(row.back())); });
    for (std::vector<Cell>& row : rows) row.emplace_back(std::int64_t{n_tests});
    return rows;
  };
  return {.columns = conclusions.labelled(
              split_list("dataset,metric,model_a,model_b,n,n_shapes,mean_difference,ci95_low,ci95_high,"
                         "t_p,ci90_low,ci90_high,d_z,rank_biserial,superiority,superiority_low,"
                         "superiority_high,rank_sum_z,rank_sum_p,signed_rank,signed_rank_p,"
                         "signed_rank_p_holm,n_tests")),
          .rows = rows_by_metric(conclusions, rows_of)};
}

Table power_table(const Conclusions& conclusions) {
  const auto rows_of = [](const DatasetScores& scores, const RankedMetric& ranked, const Metric& metric) {
    return pair_rows(scores, ranked.metric, metric.name, power_cells);
  };
  return {.columns = conclusions.labelled({"dataset", "metric", "model_a", "model_b", "n", "n_shapes", "sd",
                                           "detectable", "mean_difference", "n_to_detect"}),
          .rows = rows_by_metric(conclusions, rows_of)};
}

}  // namespace salbench
