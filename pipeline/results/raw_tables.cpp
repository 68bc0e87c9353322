// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/raw_tables.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <tuple>

#include "pipeline/results/table_rows.h"
#include "pipeline/rules/models.h"

namespace salbench {
namespace {

using ShapeName = std::tuple<std::string, std::string, std::string>;
ShapeName shape_of(const ResultRow& row) { return {row.dataset, row.item, row.view}; }
bool same_shape(const ResultRow& a, const ResultRow& b) {
  return a.item == b.item && a.view == b.view && a.dataset == b.dataset;
}

// Number of a name, given out in the order of first use.
std::size_t number_of(std::map<std::string, std::size_t>& numbers, const std::string& name) {
  return numbers.emplace(name, numbers.size()).first->second;
}

// Rows of one data set, or of one of its splits, by number of their item and of their model.
struct NumberedRows {
  struct Place {
    const ResultRow* row;
    std::size_t item, model;
  };
  std::vector<Place> places;
  std::vector<std::string> models;
  std::size_t items = 0;
};

NumberedRows numbered(const std::vector<ResultRow>& rows, std::string_view dataset,
                      const std::string& split) {
  NumberedRows part;
  std::map<std::string, std::size_t> items, models;
  for (const ResultRow& row : rows) {
    if (row.dataset != dataset || (!split.empty() && row.split != split)) continue;
    const std::size_t model = number_of(models, row.model);
    if (model == part.models.size()) part.models.push_back(row.model);
    part.places.push_back({&row, number_of(items, row.item), model});
  }
  part.items = items.size();
  return part;
}

struct Mean {
  std::int64_t n = 0;
  double mean = std::numeric_limits<double>::quiet_NaN();
};

// [model]
std::vector<Mean> means_of(const NumberedRows& part, std::size_t metric) {
  struct Sum {
    double sum = 0;
    std::int64_t n = 0;
  };
  std::vector<Sum> of_item(part.models.size() * part.items);
  for (const auto& [row, item, model] : part.places) {
    const double value = row->value(metric);
    if (std::isnan(value)) continue;
    Sum& sum = of_item[model * part.items + item];
    sum.sum += value;
    ++sum.n;
  }
  std::vector<Mean> means(part.models.size());
  for (std::size_t model = 0; model < means.size(); ++model) {
    Sum total;
    for (std::size_t item = 0; item < part.items; ++item)
      if (const auto& [sum, n] = of_item[model * part.items + item]; n > 0) {
        total.sum += sum / static_cast<double>(n);
        ++total.n;
      }
    if (total.n > 0) means[model] = {total.n, total.sum / static_cast<double>(total.n)};
  }
  return means;
}

}  // namespace

std::vector<MeshCurve> collect_human_curves(const RunState& run) {
  std::vector<MeshCurve> curves;
  for (const Job& job : run.project().jobs()) {
    if (!has_role(run.project().rule(job), Role::curve) || !run.decision(job).known()) continue;
    const DatasetItem& item = item_of(run.units(), job.unit);
    curves.push_back({item.name, item.category, value_as<HumanCurve>(*run.resolver.value(job))});
  }
  return curves;
}

Table people_table(const std::vector<MeshCurve>& curves, const Metrics& metrics) {
  Table table{.columns = {"item", "class", "n"}, .rows = {}};
  for (const Metric& metric : metrics) table.columns.push_back(metric.name);
  for (const MeshCurve& mesh : curves)
    for (std::size_t i = 0; i < mesh.curve.size(); ++i) {
      const std::vector<double> values = in_range(metrics, mesh.curve[i]).values;
      table.rows.push_back(
          cells(mesh.item, mesh.category, i + 1, std::vector<Cell>(values.begin(), values.end())));
    }
  return table;
}

Table smoothed_table(const RunState& run, const Metrics& metrics) {
  Table table;
  for (std::size_t k = 0; k < run.config.metrics.smoothing.size(); ++k) {
    const Table scores = results_table(collect_smoothed(run, k), metrics);
    table.columns = scores.columns;
    for (const std::vector<Cell>& row : scores.rows) {
      table.rows.push_back({run.config.metrics.smoothing[k]});
      table.rows.back().insert(table.rows.back().end(), row.begin(), row.end());
    }
  }
  table.columns.insert(table.columns.begin(), "smoothing");
  return table;
}

Table fitted_table(const RunState& run) {
  Table table{.columns = {"dataset", "model", "fold", "shapes", "blur", "gain", "of", "at", "log_density"},
              .rows = {}};
  for (const Job& job : run.project().jobs_of(Unit{})) {
    const Rule& rule = run.project().rule(job);
    if (!has_role(rule, Role::density_fits) || !run.decision(job).known()) continue;
    const ValuePtr value = run.resolver.value(job);
    const auto& fits = value_as<DensityFits>(*value);
    for (std::size_t fold = 0; fold < fits.size(); ++fold) {
      const DensityFit& fit = fits[fold];
      const auto add_knots = [&](const char* of, const auto& knots) {
        for (std::size_t k = 0; k < knots.size(); ++k)
          table.rows.push_back(cells(
              std::string(shapes_name(rule.over)), rule.subject, fold, fit.shapes, fit.blur, fit.gain,
              std::string(of), static_cast<double>(k) / static_cast<double>(knots.size() - 1), knots[k]));
      };
      if (fit.shapes == 0) continue;
      add_knots("value", fit.value);
      add_knots("distance", fit.distance);
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
  std::map<ShapeName, const ResultRow*> of_shape;
  for (const ResultRow& row : varying) of_shape[shape_of(row)] = &row;
  std::vector<ResultRow> constant;
  for (const ResultRow& row : rows) {
    if (!constant.empty() && same_shape(constant.back(), row)) continue;
    const auto known = of_shape.find(shape_of(row));
    Scores scores{.values = {}, .n_points = row.scores.n_points, .n_picks = row.scores.n_picks};
    std::size_t next = 0;
    for (const std::optional<double>& value : of_every_shape)
      scores.values.push_back(value                     ? *value
                              : known != of_shape.end() ? known->second->value(next++)
                                                        : std::numeric_limits<double>::quiet_NaN());
    constant.push_back({row.dataset,
                        row.item,
                        row.category,
                        row.view,
                        std::string(kConstantMap),
                        std::move(scores),
                        {},
                        row.split});
  }
  return constant;
}

Table means_table(const std::vector<ResultRow>& rows, const Metrics& metrics) {
  const bool in_splits = any_in_splits(rows);
  Table table{.columns = {"dataset", "metric", "model", "n", "mean"}, .rows = {}};
  if (in_splits) table.columns.insert(table.columns.begin() + 1, "split");
  for (const std::string_view dataset : kShapeNames) {
    std::vector<std::string> splits = splits_among(rows, dataset);
    const bool several = !splits.empty();
    splits.insert(splits.begin(), "");
    for (const std::string& split : splits) {
      const NumberedRows part = numbered(rows, dataset, split);
      if (part.places.empty()) continue;
      std::vector<Cell> label = {std::string(dataset)};
      if (in_splits) label.emplace_back(several ? split : part.places.front().row->split);
      for (std::size_t m = 0; m < metrics.size(); ++m) {
        const std::vector<Mean> means = means_of(part, m);
        for (std::size_t model = 0; model < means.size(); ++model)
          table.rows.push_back(
              cells(label, metrics[m].name, part.models[model], means[model].n, means[model].mean));
      }
    }
  }
  return table;
}

std::vector<std::string> splits_among(const std::vector<ResultRow>& rows, std::string_view dataset) {
  std::vector<std::string> splits;
  for (const ResultRow& row : rows) {
    if (row.dataset != dataset) continue;
    if (std::ranges::find(splits, row.split) == splits.end()) splits.push_back(row.split);
  }
  if (splits.size() < 2) return {};
  std::erase(splits, "");
  return splits;
}

}  // namespace salbench
