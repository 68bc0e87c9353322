// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/statistics.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "stages/metrics/metrics.h"
#include "stages/stats/multiple.h"
#include "stages/stats/rank_tests.h"
#include "stages/stats/summary.h"

namespace salbench {
namespace {

// Rows of one model by shape: paired tests need to know which belong together.
using ByShape = std::map<std::string, const ResultRow*>;

ByShape rows_by_shape(const std::vector<ResultRow>& rows, const DatasetAndModel& of) {
  ByShape by_shape;
  for (const ResultRow& row : rows)
    if (row.dataset == of.dataset && row.model == of.model) by_shape[row.item + "/" + row.view] = &row;
  return by_shape;
}

std::vector<double> values_of(const ByShape& rows, std::size_t metric) {
  std::vector<double> values;
  for (const auto& [shape, row] : rows) values.push_back(row->value(metric));
  return values;
}

// Scores of shapes that both models have one for.
std::pair<std::vector<double>, std::vector<double>> paired(const ByShape& a, const ByShape& b,
                                                           std::size_t metric) {
  std::pair<std::vector<double>, std::vector<double>> pairs;
  for (const auto& [shape, row] : a) {
    const auto other = b.find(shape);
    if (other == b.end() || std::isnan(row->value(metric)) || std::isnan(other->second->value(metric)))
      continue;
    pairs.first.push_back(row->value(metric));
    pairs.second.push_back(other->second->value(metric));
  }
  return pairs;
}

// Columns of a table by class: AUC alone for the paper's metrics, as in the paper.
std::vector<std::size_t> metrics_by_class(const Metrics& metrics) {
  std::vector<std::size_t> all(metrics.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  if (std::ranges::equal(metrics, chosen_metrics({}), {}, &Metric::name, &Metric::name)) all.resize(1);
  return all;
}

void add_class_rows(Table& table, const std::string& dataset, const std::string& category,
                    const std::vector<ResultRow>& rows, const Metrics& metrics) {
  const std::vector<std::size_t> columns = metrics_by_class(metrics);
  std::map<std::string, std::vector<const ResultRow*>> by_model;
  for (const ResultRow& row : rows)
    if (row.dataset == dataset && row.category == category) by_model[row.model].push_back(&row);
  std::vector<std::vector<double>> means(columns.size());
  const auto add = [&](const std::string& model, const std::vector<Summary>& summaries) {
    auto& cells = table.rows.emplace_back(std::vector<Cell>{dataset, category, model, summaries.front().n});
    for (std::size_t c = 0; c < columns.size(); ++c) {
      cells.insert(cells.end(), {summaries[c].mean, (summaries[c].ci_high - summaries[c].ci_low) / 2});
      means[c].push_back(summaries[c].mean);
    }
  };
  const auto summaries_of = [&](const auto& values_of_column) {
    std::vector<Summary> summaries;
    for (std::size_t c = 0; c < columns.size(); ++c) summaries.push_back(summarise(values_of_column(c)));
    return summaries;
  };
  for (const DatasetAndModel& of : datasets_and_models(rows)) {
    if (of.dataset != dataset || !by_model.contains(of.model)) continue;
    add(of.model, summaries_of([&](std::size_t c) {
          std::vector<double> values;
          for (const ResultRow* row : by_model[of.model]) values.push_back(row->value(columns[c]));
          return values;
        }));
  }
  add(columns.size() == 1 && metrics.front().name == "auc" ? "Avg-AUC" : "Avg",
      summaries_of([&](std::size_t c) { return means[c]; }));
}

struct RowsOfModel {
  DatasetAndModel of;
  ByShape rows;
};

void add_significance_rows(Table& table, const std::vector<RowsOfModel>& models, const Metrics& metrics,
                           std::size_t metric) {
  std::vector<std::vector<Cell>> added;
  std::vector<double> p_values;
  for (std::size_t i = 0; i < models.size(); ++i) {
    for (std::size_t j = i + 1; j < models.size(); ++j) {
      const RankSum rank_sum =
          rank_sum_test(values_of(models[i].rows, metric), values_of(models[j].rows, metric));
      const auto [x, y] = paired(models[i].rows, models[j].rows, metric);
      const SignedRank signed_rank = signed_rank_test(x, y);
      std::vector<double> differences;
      for (std::size_t k = 0; k < x.size(); ++k) differences.push_back(x[k] - y[k]);
      added.push_back({models[i].of.dataset, metrics[metric].name, models[i].of.model, models[j].of.model,
                       static_cast<std::int64_t>(x.size()), summarise(differences).mean, rank_sum.z,
                       rank_sum.p_value, signed_rank.statistic, signed_rank.p_value});
      p_values.push_back(signed_rank.p_value);
    }
  }
  const std::vector<double> adjusted = holm_adjusted(p_values);
  for (std::size_t k = 0; k < added.size(); ++k) {
    added[k].emplace_back(adjusted[k]);
    table.rows.push_back(std::move(added[k]));
  }
}

}  // namespace

Table per_class_table(const std::vector<ResultRow>& rows, const Metrics& metrics) {
  Table table{.columns = {"dataset", "class", "model", "n"}, .rows = {}};
  for (const std::size_t m : metrics_by_class(metrics))
    for (const char* part : {"_mean", "_ci95"}) table.columns.push_back(metrics[m].name + part);
  std::vector<std::pair<std::string, std::string>> classes;  // in the order of their first item
  for (const std::string_view dataset : EnumNames<Shapes>::names)
    for (const ResultRow& row : rows)
      if (const std::pair key(row.dataset, row.category);
          row.dataset == dataset && !row.category.empty() &&
          std::find(classes.begin(), classes.end(), key) == classes.end())
        classes.push_back(key);
  for (const auto& [dataset, category] : classes) add_class_rows(table, dataset, category, rows, metrics);
  return table;
}

Table significance_table(const std::vector<ResultRow>& rows, const Metrics& metrics) {
  Table table{.columns = {"dataset", "metric", "model_a", "model_b", "n", "mean_difference", "rank_sum_z",
                          "rank_sum_p", "signed_rank", "signed_rank_p", "signed_rank_p_holm"},
              .rows = {}};
  for (const std::string_view dataset : EnumNames<Shapes>::names) {
    std::vector<RowsOfModel> models;
    for (const DatasetAndModel& of : datasets_and_models(rows))
      if (of.dataset == dataset) models.push_back({of, rows_by_shape(rows, of)});
    for (std::size_t m = 0; m < metrics.size(); ++m) add_significance_rows(table, models, metrics, m);
  }
  return table;
}

Table human_curve_table(const std::vector<HumanCurve>& curves, const Metrics& metrics) {
  Table table{.columns = {"n", "metric", "n_meshes", "mean", "sd", "ci95_low", "ci95_high"}, .rows = {}};
  std::size_t longest = 0;
  for (const HumanCurve& curve : curves) longest = std::max(longest, curve.size());
  for (std::size_t i = 0; i < longest; ++i) {
    for (std::size_t m = 0; m < metrics.size(); ++m) {
      std::vector<double> values;
      for (const HumanCurve& curve : curves)
        if (i < curve.size()) values.push_back(curve[i].values.at(m));
      const Summary summary = summarise(values);
      table.rows.push_back({static_cast<std::int64_t>(i + 1), metrics[m].name, summary.n, summary.mean,
                            summary.sd, summary.ci_low, summary.ci_high});
    }
  }
  return table;
}

std::vector<HumanCurve> collect_human_curves(const RunState& run) {
  std::vector<HumanCurve> curves;
  for (std::size_t row = 0; row < run.plan.jobs.size(); ++row) {
    if (run.context.catalog.rows[row].kind != "human_curve") continue;
    for (const Item& item : items_of(run.context, row))
      if (run.plan[{row, item}].known())
        curves.push_back(std::get<HumanCurve>(*run.runner.result({row, item})));
  }
  return curves;
}

Table mean_histogram_table(const RunState& run, Shapes shapes) {
  Table table{.columns = {"bin_left"}, .rows = std::vector<std::vector<Cell>>(kHistogramBins)};
  for (std::size_t bin = 0; bin < kHistogramBins; ++bin)
    table.rows[bin].emplace_back(static_cast<double>(bin) / kHistogramBins);
  for (std::size_t r = 0; r < run.plan.jobs.size(); ++r) {
    const Row& row = run.context.catalog.rows[r];
    const JobRef job{r, Item::set()};
    if (row.kind != "histogram" || row.shapes != shapes || !run.plan[job].known()) continue;
    const std::size_t dot = row.name.find('.');  // "mean_histogram.LS", or "reference"
    table.columns.push_back(dot == std::string::npos ? "GS" : row.name.substr(dot + 1));
    const auto histogram = std::get<Histogram>(*run.runner.result(job));
    for (std::size_t bin = 0; bin < kHistogramBins; ++bin) table.rows[bin].emplace_back(histogram[bin]);
  }
  return table;
}

}  // namespace salbench
