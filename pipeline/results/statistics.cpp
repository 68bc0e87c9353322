#include "pipeline/results/statistics.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "stages/metrics/metrics.h"
#include "stages/stats/multiple.h"
#include "stages/stats/rank_tests.h"
#include "stages/stats/summary.h"

namespace salbench {
namespace {

// Scores of one model under one metric by shape: paired tests need to know which belong together.
using ByShape = std::map<std::string, double>;

ByShape scores_by_shape(const std::vector<ResultRow>& rows, const DatasetAndModel& of, const Metric& metric) {
  ByShape scores;
  for (const ResultRow& row : rows)
    if (row.dataset == of.dataset && row.model == of.model)
      scores[row.item + "/" + row.view] = value_of(row.scores, metric.name);
  return scores;
}

std::vector<double> values_of(const ByShape& scores) {
  std::vector<double> values;
  for (const auto& [shape, value] : scores) values.push_back(value);
  return values;
}

// Shapes that both models have a score for.
std::pair<std::vector<double>, std::vector<double>> paired(const ByShape& a, const ByShape& b) {
  std::pair<std::vector<double>, std::vector<double>> pairs;
  for (const auto& [shape, value] : a) {
    const auto other = b.find(shape);
    if (other == b.end() || std::isnan(value) || std::isnan(other->second)) continue;
    pairs.first.push_back(value);
    pairs.second.push_back(other->second);
  }
  return pairs;
}

void add_class_rows(Table& table, const std::string& dataset, const std::string& category,
                    const std::vector<ResultRow>& rows) {
  std::map<std::string, std::vector<double>> by_model;
  for (const ResultRow& row : rows)
    if (row.dataset == dataset && row.category == category)
      by_model[row.model].push_back(value_of(row.scores, "auc"));
  std::vector<double> means;
  const auto add = [&](const std::string& model, const std::vector<double>& values) {
    const Summary summary = summarise(values);
    table.rows.push_back(
        {dataset, category, model, summary.n, summary.mean, (summary.ci_high - summary.ci_low) / 2});
    means.push_back(summary.mean);
  };
  for (const DatasetAndModel& of : datasets_and_models(rows))
    if (of.dataset == dataset && by_model.contains(of.model)) add(of.model, by_model[of.model]);
  add("Avg-AUC", std::vector<double>(means));
}

void add_significance_rows(Table& table, const std::vector<DatasetAndModel>& models, const Metric& metric,
                           const std::vector<ResultRow>& rows) {
  std::vector<std::vector<Cell>> added;
  std::vector<double> p_values;
  for (std::size_t i = 0; i < models.size(); ++i) {
    for (std::size_t j = i + 1; j < models.size(); ++j) {
      const ByShape a = scores_by_shape(rows, models[i], metric),
                    b = scores_by_shape(rows, models[j], metric);
      const RankSum rank_sum = rank_sum_test(values_of(a), values_of(b));
      const auto [x, y] = paired(a, b);
      const SignedRank signed_rank = signed_rank_test(x, y);
      std::vector<double> differences;
      for (std::size_t k = 0; k < x.size(); ++k) differences.push_back(x[k] - y[k]);
      added.push_back({models[i].dataset, std::string(metric.name), models[i].model, models[j].model,
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

Table per_class_table(const std::vector<ResultRow>& rows) {
  Table table{.columns = {"dataset", "class", "model", "n", "auc_mean", "auc_ci95"}, .rows = {}};
  std::vector<std::pair<std::string, std::string>> classes;  // in the order of their first item
  for (const std::string_view dataset : EnumNames<Shapes>::names)
    for (const ResultRow& row : rows)
      if (const std::pair key(row.dataset, row.category);
          row.dataset == dataset && !row.category.empty() &&
          std::find(classes.begin(), classes.end(), key) == classes.end())
        classes.push_back(key);
  for (const auto& [dataset, category] : classes) add_class_rows(table, dataset, category, rows);
  return table;
}

Table significance_table(const std::vector<ResultRow>& rows) {
  Table table{.columns = {"dataset", "metric", "model_a", "model_b", "n", "mean_difference", "rank_sum_z",
                          "rank_sum_p", "signed_rank", "signed_rank_p", "signed_rank_p_holm"},
              .rows = {}};
  for (const std::string_view dataset : EnumNames<Shapes>::names) {
    std::vector<DatasetAndModel> models;
    for (const DatasetAndModel& of : datasets_and_models(rows))
      if (of.dataset == dataset) models.push_back(of);
    for (const Metric& metric : metric_table()) add_significance_rows(table, models, metric, rows);
  }
  return table;
}

Table human_curve_table(const std::vector<HumanCurve>& curves) {
  Table table{.columns = {"n", "metric", "n_meshes", "mean", "sd", "ci95_low", "ci95_high"}, .rows = {}};
  std::size_t longest = 0;
  for (const HumanCurve& curve : curves) longest = std::max(longest, curve.size());
  for (std::size_t i = 0; i < longest; ++i) {
    for (const Metric& metric : metric_table()) {
      std::vector<double> values;
      for (const HumanCurve& curve : curves)
        if (i < curve.size()) values.push_back(value_of(curve[i], metric.name));
      const Summary summary = summarise(values);
      table.rows.push_back({static_cast<std::int64_t>(i + 1), std::string(metric.name), summary.n,
                            summary.mean, summary.sd, summary.ci_low, summary.ci_high});
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
    if (!row.gathers || row.shapes != shapes || !run.plan[job].known()) continue;
    const std::size_t dot = row.name.find('.');  // "mean_histogram.LS", or "reference"
    table.columns.push_back(dot == std::string::npos ? "GS" : row.name.substr(dot + 1));
    const auto histogram = std::get<Histogram>(*run.runner.result(job));
    for (std::size_t bin = 0; bin < kHistogramBins; ++bin) table.rows[bin].emplace_back(histogram[bin]);
  }
  return table;
}

}  // namespace salbench
