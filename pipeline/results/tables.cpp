// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/tables.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "pipeline/rules/models.h"
#include "stages/core/check.h"
#include "stages/metrics/measure.h"
#include "stages/metrics/score.h"

namespace salbench {
namespace {

bool any_in_splits(const std::vector<ResultRow>& rows) {
  return std::ranges::any_of(rows, [](const ResultRow& row) { return !row.split.empty(); });
}

// Inserts the split, or its column title, as the second cell if items have splits.
template <class T>
void add_split(std::vector<T>& row, bool in_splits, const std::string& split) {
  if (in_splits) row.insert(row.begin() + 1, split);
}

std::vector<std::string> result_columns(bool in_splits, const Metrics& metrics) {
  std::vector<std::string> columns = {"dataset", "item", "class", "view", "model"};
  for (const Metric& metric : metrics) columns.push_back(metric.name);
  columns.insert(columns.end(), {"n_points", "n_picks"});
  add_split(columns, in_splits, "split");
  return columns;
}

std::vector<Cell> result_cells(const ResultRow& row, bool in_splits, const Metrics& metrics) {
  const auto& [values, n_points, n_picks] = row.scores;
  CHECK_EQ(values.size(), metrics.size());
  std::vector<Cell> cells = {row.dataset, row.item, row.category, row.view, row.model};
  cells.insert(cells.end(), values.begin(), values.end());
  cells.insert(cells.end(), {n_points, n_picks});
  add_split(cells, in_splits, row.split);
  return cells;
}

// Streams to_csv(results_table(...)): all cells at once take six times the memory of the text.
std::string results_text(const std::vector<ResultRow>& rows, const Metrics& metrics,
                         const std::vector<std::string>& remarks) {
  const bool in_splits = any_in_splits(rows);
  std::string text = to_csv({.columns = result_columns(in_splits, metrics), .rows = {}, .remarks = remarks});
  for (const ResultRow& row : rows) {
    std::vector<Cell> cells = result_cells(row, in_splits, metrics);
    if (!remarks.empty()) cells.emplace_back(joined_remarks(remarks));
    append_csv_line(text, cells);
  }
  return text;
}

// --- means ------------------------------------------------------------------------------------------------

using RowPtrs = std::vector<const ResultRow*>;
using Groups = std::vector<std::pair<std::string, RowPtrs>>;

// Groups rows by a text field, in the order of first occurrence.
Groups grouped(const RowPtrs& rows, std::string ResultRow::*by) {
  Groups groups;
  std::map<std::string_view, std::size_t> place;
  for (const ResultRow* row : rows) {
    const auto [known, is_new] = place.emplace(row->*by, groups.size());
    if (is_new) groups.push_back({row->*by, {}});
    groups[known->second].second.push_back(row);
  }
  return groups;
}

// All rows of a data set under the name of its split; with several splits, all rows without a name first,
// then each split.
Groups by_split(const std::vector<ResultRow>& rows, std::string_view dataset) {
  RowPtrs all;
  for (const ResultRow& row : rows)
    if (row.dataset == dataset) all.push_back(&row);
  Groups splits = grouped(all, &ResultRow::split);
  if (splits.size() < 2) return splits;
  std::erase_if(splits, [](const auto& split) { return split.first.empty(); });
  splits.insert(splits.begin(), {"", std::move(all)});
  return splits;
}

// Ignores NaN.
struct Sum {
  double sum = 0;
  std::int64_t n = 0;

  void add(double value) {
    if (std::isnan(value)) return;
    sum += value;
    ++n;
  }
  double mean() const { return n > 0 ? sum / static_cast<double>(n) : kUndefined; }
};

Sum sum_over(const Groups& items, std::size_t metric) {
  Sum total;
  for (const auto& [item, views] : items) {
    Sum of_item;
    for (const ResultRow* view : views) of_item.add(view->value(metric));
    total.add(of_item.mean());
  }
  return total;
}

// --- other tables -----------------------------------------------------------------------------------------

// bin_left, then one column for the ground truth (GS) and each model: mean 100-bin density histograms of the
// unmatched, min-max-normalised maps. [tasse2016]
Table mean_histogram_table(const RunState& run, Level level) {
  Table table{.columns = {"bin_left"}, .rows = std::vector<std::vector<Cell>>(kHistogramBins)};
  for (std::size_t bin = 0; bin < kHistogramBins; ++bin)
    table.rows[bin].emplace_back(static_cast<double>(bin) / kHistogramBins);
  for (const Role role : {Role::reference, Role::mean_histogram})
    for (const Job& job : run.known(role)) {
      const Rule& rule = run.project().rule(job);
      if (rule.over != level) continue;
      table.columns.push_back(role == Role::reference ? "GS" : rule.subject);
      const ValuePtr histogram = run.resolver.value(job);
      for (std::size_t bin = 0; bin < kHistogramBins; ++bin)
        table.rows[bin].emplace_back(value_as<Histogram>(*histogram)[bin]);
    }
  return table;
}

// One row per shape and person: counts of the recording, its seconds, and the reason of exclusion, empty for
// included people. No rows without recordings.
Table gaze_table(const RunState& run) {
  Table table{.columns = {"item", "class", "person", "samples", "lost", "fixations", "hits", "snapped",
                          "missed", "seconds", "recorded", "tracked", "left_out"},
              .rows = {}};
  for (const Job& job : run.known(Role::gaze_hits)) {
    const Item& item = item_of(run.units(), job.unit);
    const ValuePtr value = run.resolver.value(job);
    const auto& hits = value_as<GazeHits>(*value);
    const GazePeople& people = hits.people;
    const std::vector<GazeCounts> counts = counts_by_person(hits);
    const std::vector<std::string> left_out = left_out_people(people, run.config.gaze.truth.people);
    for (std::size_t p = 0; p < counts.size(); ++p) {
      const GazeCounts& own = counts[p];
      const std::string why = left_out[p].empty() && own.hits == 0 ? "no fixation on the shape" : left_out[p];
      table.rows.push_back({item.name, item.category, people.names[p], people.samples[p], people.lost[p],
                            own.fixations, own.hits, own.snapped, own.fixations - own.hits,
                            own.on_shape / 1000, people.recorded[p] / 1000, people.tracked[p] / 1000, why});
    }
  }
  return table;
}

}  // namespace

Table results_table(const std::vector<ResultRow>& rows, const Metrics& metrics) {
  const bool in_splits = any_in_splits(rows);
  Table table{.columns = result_columns(in_splits, metrics), .rows = {}};
  for (const ResultRow& row : rows) table.rows.push_back(result_cells(row, in_splits, metrics));
  return table;
}

Table means_table(const std::vector<ResultRow>& rows, const Metrics& metrics) {
  const bool in_splits = any_in_splits(rows);
  Table table{.columns = {"dataset", "metric", "model", "n", "mean"}, .rows = {}};
  add_split(table.columns, in_splits, "split");
  for (const Level level : kShapeLevels)
    for (const auto& [split, of_split] : by_split(rows, shapes_name(level))) {
      std::vector<std::pair<std::string, Groups>> models;
      for (const auto& [model, of_model] : grouped(of_split, &ResultRow::model))
        models.emplace_back(model, grouped(of_model, &ResultRow::item));
      for (std::size_t m = 0; m < metrics.size(); ++m)
        for (const auto& [model, items] : models) {
          const Sum sum = sum_over(items, m);
          table.rows.push_back({std::string(shapes_name(level)), metrics[m].name, model, sum.n, sum.mean()});
          add_split(table.rows.back(), in_splits, split);
        }
    }
  return table;
}

std::vector<ResultRow> rows_of_constant(const std::vector<ResultRow>& rows,
                                        const std::vector<ResultRow>& varying,
                                        const MetricsOptions& options) {
  std::vector<std::optional<double>> of_every_shape;
  for (const Metric& metric : chosen_metrics(options))
    of_every_shape.push_back(score_of_constant(metric, options));
  std::map<Unit, const ResultRow*> of_shape;
  for (const ResultRow& row : varying) of_shape[row.job.unit] = &row;
  std::vector<ResultRow> constant;
  for (const ResultRow& row : rows) {
    if (!constant.empty() && constant.back().job.unit == row.job.unit) continue;
    ResultRow& shape = constant.emplace_back(row);
    shape.model = kConstantMap;
    shape.scores.values.clear();
    const auto known = of_shape.find(row.job.unit);
    std::size_t next = 0;
    for (const std::optional<double>& value : of_every_shape)
      shape.scores.values.push_back(value                     ? *value
                                    : known != of_shape.end() ? known->second->value(next++)
                                                              : kUndefined);
  }
  return constant;
}

Table people_table(const RunState& run, const Metrics& metrics) {
  Table table{.columns = {"item", "class", "n"}, .rows = {}};
  for (const Metric& metric : metrics) table.columns.push_back(metric.name);
  for (const Job& job : run.known(Role::curve)) {
    const Item& item = item_of(run.units(), job.unit);
    const ValuePtr curve = run.resolver.value(job);
    for (std::size_t n = 1; const Scores& scores : value_as<HumanCurve>(*curve)) {
      const std::vector<double> values = in_range(metrics, scores).values;
      table.rows.push_back({item.name, item.category, cell_of(n++)});
      table.rows.back().insert(table.rows.back().end(), values.begin(), values.end());
    }
  }
  return table;
}

Table smoothed_table(const RunState& run, const Metrics& metrics) {
  Table table;
  for (std::size_t k = 0; k < run.config.metrics.smoothing.size(); ++k) {
    Table scores = results_table(collect_smoothed(run, k), metrics);
    table.columns = std::move(scores.columns);
    for (std::vector<Cell>& row : scores.rows) {
      row.insert(row.begin(), run.config.metrics.smoothing[k]);
      table.rows.push_back(std::move(row));
    }
  }
  table.columns.insert(table.columns.begin(), "smoothing");
  return table;
}

std::vector<TableFile> table_files(const RunState& run, const std::vector<ResultRow>& rows,
                                   const std::vector<std::string>& remarks) {
  const MetricsOptions& options = run.config.metrics;
  const Metrics metrics = chosen_metrics(options);
  const Table people = people_table(run, metrics), gaze = gaze_table(run);
  const auto text_if = [&](bool there, Table table) -> std::optional<std::string> {
    if (!there) return std::nullopt;
    table.remarks = remarks;
    return to_csv(table);
  };
  std::vector<TableFile> files = {
      {"results.csv", results_text(rows, metrics, remarks)},
      {"means.csv", text_if(true, means_table(rows, metrics))},
      {"constant.csv",
       results_text(rows_of_constant(rows, collect_constant(run), options), metrics, remarks)},
      {"people.csv", text_if(!people.rows.empty(), people)},
      {"smoothed.csv", text_if(!options.smoothing.empty(), smoothed_table(run, metrics))},
      {"gaze.csv", text_if(!gaze.rows.empty(), gaze), false}};
  for (const Level level : kShapeLevels) {
    const Table histograms = mean_histogram_table(run, level);
    files.push_back({fmt::format("mean_histograms_{}.csv", shapes_name(level)),
                     text_if(histograms.columns.size() > 1, histograms), false});
  }
  return files;
}

std::vector<std::string> names_of_tables() {
  std::vector<std::string> names = {"results.csv",
                                    "means.csv",
                                    "constant.csv",
                                    "people.csv",
                                    "smoothed.csv",
                                    "gaze.csv",
                                    "costs.csv",
                                    std::string(kFoldsTable),
                                    std::string(kTrainingTable)};
  for (const Level level : kShapeLevels)
    names.push_back(fmt::format("mean_histograms_{}.csv", shapes_name(level)));
  return names;
}

}  // namespace salbench
