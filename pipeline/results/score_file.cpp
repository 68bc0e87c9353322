// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/score_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "io/table.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

bool has_column(const Table& table, std::string_view name) {
  return std::ranges::find(table.columns, name) != table.columns.end();
}

// Empty cells where there is no such column.
std::vector<std::string> words_of(const Table& table, std::string_view name) {
  return has_column(table, name) ? text_column(table, name) : std::vector<std::string>(table.rows.size());
}

struct ScoreColumn {
  Metric metric;
  std::vector<double> values;
};

Metric named_metric(std::string_view name, bool higher_is_better) {
  Metric metric{};
  metric.name = name;
  metric.higher_is_better = higher_is_better;
  return metric;
}

std::vector<Metric> metrics_to_read(const ScoreColumns& columns) {
  std::vector<Metric> metrics(metric_table().begin(), metric_table().end());
  for (const std::string& name : columns.higher_is_better) metrics.push_back(named_metric(name, true));
  for (const std::string& name : columns.lower_is_better) metrics.push_back(named_metric(name, false));
  return metrics;
}

std::vector<ScoreColumn> score_columns(const Table& table, const ScoreColumns& columns) {
  std::vector<ScoreColumn> found;
  for (const Metric& metric : metrics_to_read(columns)) {
    if (has_column(table, metric.name))
      found.push_back({metric, number_column(table, metric.name)});
    else if (metric.name == "lcc" && has_column(table, "cc"))
      found.push_back({metric, number_column(table, "cc")});
    if (!found.empty() && metric.name == "lcc" && found.back().metric.name == "lcc")
      for (double& value : found.back().values) value = std::abs(value);
  }
  for (const std::vector<std::string>& named : {columns.higher_is_better, columns.lower_is_better})
    for (const std::string& name : named)
      if (!has_column(table, name)) throw InputError(fmt::format("{}: no column '{}'", table.name, name));
  if (found.empty())
    throw InputError(fmt::format(
        "{}: no column is a metric; name the columns of scores with --higher or --lower; there are {}",
        table.name, fmt::join(table.columns, ", ")));
  for (const ScoreColumn& column : found)
    for (std::size_t row = 0; row < column.values.size(); ++row)
      if (std::isinf(column.values[row]))
        throw InputError(fmt::format("{}:{}: {} is infinite: no score can be", table.name, table.lines[row],
                                     column.metric.name));
  return found;
}

std::map<std::string, std::string> read_classes(const fs::path& path) {
  if (path.empty()) return {};
  const Table table = read_csv(path);
  const std::vector<std::string> items = text_column(table, "item"), classes = text_column(table, "class");
  std::map<std::string, std::string> found;
  for (std::size_t i = 0; i < items.size(); ++i)
    if (!found.emplace(items[i], classes[i]).second)
      throw InputError(
          fmt::format("{}:{}: item '{}' has a class already", table.name, table.lines[i], items[i]));
  return found;
}

std::vector<std::string> notes_of(const Table& table, const std::vector<ScoreColumn>& scores) {
  std::set<std::string, std::less<>> known{"dataset", "item",     "class",   "view",
                                           "model",   "n_points", "n_picks", "split"};
  for (const ScoreColumn& column : scores) known.insert(column.metric.name);
  std::vector<std::string> left_out;
  std::ranges::copy_if(table.columns, std::back_inserter(left_out),
                       [&](const std::string& name) { return !known.contains(name); });
  std::vector<std::string> notes;
  for (const std::string& remark : table.remarks) notes.push_back(fmt::format("{}: {}", table.name, remark));
  if (!left_out.empty())
    notes.push_back(
        fmt::format("{}: columns that are no metrics of the program were left out: {}; name them with "
                    "--higher or --lower",
                    table.name, fmt::join(left_out, ", ")));
  return notes;
}

}  // namespace

ScoreFile read_scores(const fs::path& path, const ScoreColumns& columns, const fs::path& classes) {
  return scores_from(read_csv(path), columns, classes);
}

std::vector<std::string> names_of_scores(const Table& table, const ScoreColumns& columns) {
  std::vector<std::string> names;
  for (const Metric& metric : metrics_to_read(columns))
    if (has_column(table, metric.name)) names.push_back(metric.name);
  return names;
}

ScoreFile scores_from(const Table& table, const ScoreColumns& columns, const fs::path& classes) {
  const std::vector<std::string> items = text_column(table, "item"), models = text_column(table, "model"),
                                 views = words_of(table, "view"), datasets = words_of(table, "dataset"),
                                 categories = words_of(table, "class"), splits = words_of(table, "split");
  const std::vector<ScoreColumn> scores = score_columns(table, columns);
  const std::map<std::string, std::string> class_of = read_classes(classes);
  ScoreFile file{{}, {}, notes_of(table, scores)};
  for (const ScoreColumn& column : scores) file.metrics.push_back(column.metric);
  std::set<std::tuple<std::string, std::string, std::string, std::string>> seen;
  for (std::size_t i = 0; i < items.size(); ++i) {
    ResultRow row{datasets[i], items[i], categories[i], views[i], models[i], {}, {}, splits[i]};
    if (row.dataset.empty()) row.dataset = row.view.empty() ? "meshes" : "scans";
    if (std::ranges::find(kShapeNames, row.dataset) == kShapeNames.end())
      throw InputError(fmt::format("{}:{}: data set '{}', expected one of {}", table.name, table.lines[i],
                                   row.dataset, fmt::join(kShapeNames, ", ")));
    if (!seen.emplace(row.dataset, row.item, row.view, row.model).second)
      throw InputError(fmt::format("{}:{}: a second row of item '{}'{}{}, model '{}'", table.name,
                                   table.lines[i], row.item, row.view.empty() ? "" : ", view ", row.view,
                                   row.model));
    if (const auto found = class_of.find(row.item); found != class_of.end()) row.category = found->second;
    for (const ScoreColumn& column : scores) row.scores.values.push_back(column.values[i]);
    file.rows.push_back(std::move(row));
  }
  if (file.rows.empty())
    throw InputError(fmt::format("{}: no scores below the names of the columns", table.name));
  return file;
}

}  // namespace salbench
