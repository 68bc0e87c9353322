// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "pipeline/results/raw_tables.h"
#include "pipeline/results/table_rows.h"
#include "stages/stats/summary.h"

namespace salbench {
namespace {

constexpr const char* kAverage = "Avg";  // no model can be called so

// In the order of their first item.
std::vector<std::pair<std::string, std::string>> datasets_and_classes(const std::vector<ResultRow>& rows) {
  std::vector<std::pair<std::string, std::string>> classes;
  for (const std::string_view dataset : kShapeNames)
    for (const ResultRow& row : rows)
      if (const std::pair key(row.dataset, row.category);
          row.dataset == dataset && !row.category.empty() && std::ranges::find(classes, key) == classes.end())
        classes.push_back(key);
  return classes;
}

// Mean of the columns, unit by unit.
std::vector<double> mean_of_columns(const Columns& columns) {
  std::vector<double> means(columns.units(), 0.0);
  for (std::size_t u = 0; u < means.size(); ++u) {
    for (std::size_t c = 0; c < columns.count; ++c) means[u] += columns.at(u, c);
    means[u] /= static_cast<double>(columns.count);
  }
  return means;
}

void add_class_rows(Table& table, const std::string& category, const DatasetScores& scores,
                    const Metrics& metrics) {
  const auto add = [&](const std::string& model, std::size_t metric, const UnitScores& of) {
    if (of.units.empty()) return;
    const Summary summary = summarise(mean_of_columns(of.scores));
    table.rows.push_back(cells(scores.label(), category, model, metrics[metric].name, summary.n, of.n_shapes,
                               summary.mean, student_interval(summary)));
  };
  for (std::size_t model = 0; model < scores.models().size(); ++model)
    for (std::size_t m = 0; m < metrics.size(); ++m)
      add(scores.models()[model], m, scores.compared(m, {&model, 1}));
  for (std::size_t m = 0; m < metrics.size(); ++m)
    add(kAverage, m, scores.compared(m, scores.competitors(m)));
}

}  // namespace

Table per_class_table(const std::vector<ResultRow>& rows, const Metrics& metrics, Observation unit) {
  // Within a class its shapes are the units.
  if (unit == Observation::item_class) unit = Observation::mesh;
  Table table{
      .columns = {"dataset", "class", "model", "metric", "n", "n_shapes", "mean", "ci95_low", "ci95_high"},
      .rows = {}};
  if (any_in_splits(rows)) table.columns.insert(table.columns.begin() + 1, "split");
  for (const auto& [dataset, category] : datasets_and_classes(rows)) {
    add_class_rows(table, category, DatasetScores(rows, dataset, unit, category), metrics);
    for (const std::string& split : splits_among(rows, dataset))
      add_class_rows(table, category, DatasetScores(rows, dataset, unit, category, split), metrics);
  }
  return table;
}

}  // namespace salbench
