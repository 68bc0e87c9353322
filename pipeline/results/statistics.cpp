// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/statistics.h"

#include <algorithm>
#include <functional>
#include <numeric>

#include "pipeline/results/unit_scores.h"
#include "stages/metrics/metrics.h"
#include "stages/stats/summary.h"

namespace salbench {
namespace {

// Columns of a table by class: AUC alone for the paper's metrics, as in the paper.
std::vector<std::size_t> metrics_by_class(const Metrics& metrics) {
  std::vector<std::size_t> all(metrics.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  if (std::ranges::equal(metrics, chosen_metrics({}), {}, &Metric::name, &Metric::name)) all.resize(1);
  return all;
}

// In the order of their first item.
std::vector<std::pair<std::string, std::string>> datasets_and_classes(const std::vector<ResultRow>& rows) {
  std::vector<std::pair<std::string, std::string>> classes;
  for (const std::string_view dataset : EnumNames<Shapes>::names)
    for (const ResultRow& row : rows)
      if (const std::pair key(row.dataset, row.category);
          row.dataset == dataset && !row.category.empty() && std::ranges::find(classes, key) == classes.end())
        classes.push_back(key);
  return classes;
}

// Model, number of units and summaries of a row.
using AddRow = std::function<void(const std::string&, const std::vector<Summary>&)>;

void add_class_rows(const DatasetScores& scores, const std::vector<std::size_t>& metrics,
                    const std::string& name_of_average, const AddRow& add) {
  std::vector<std::vector<double>> means(metrics.size());
  for (std::size_t model = 0; model < scores.models().size(); ++model) {
    std::vector<Summary> summaries;
    for (std::size_t c = 0; c < metrics.size(); ++c) {
      summaries.push_back(summarise(scores.compared(metrics[c], {&model, 1}).scores.values));
      if (!scores.is_reference(model)) means[c].push_back(summaries[c].mean);
    }
    add(scores.models()[model], summaries);
  }
  std::vector<Summary> averages;
  for (const std::vector<double>& of_metric : means) averages.push_back(summarise(of_metric));
  add(name_of_average, averages);
}

}  // namespace

Table per_class_table(const std::vector<ResultRow>& rows, const Metrics& metrics, Unit unit) {
  // Within a class its shapes are the units.
  if (unit == Unit::item_class) unit = Unit::mesh;
  const std::vector<std::size_t> columns = metrics_by_class(metrics);
  const std::string average = columns.size() == 1 && metrics.front().name == "auc" ? "Avg-AUC" : "Avg";
  Table table{.columns = {"dataset", "class", "model", "n"}, .rows = {}};
  for (const std::size_t m : columns)
    for (const char* part : {"_mean", "_ci95"}) table.columns.push_back(metrics[m].name + part);
  for (const auto& [dataset, category] : datasets_and_classes(rows))
    add_class_rows(DatasetScores(rows, dataset, unit, category), columns, average,
                   [&, &dataset = dataset, &category = category](const std::string& model,
                                                                 const std::vector<Summary>& summaries) {
                     auto& cells = table.rows.emplace_back(
                         std::vector<Cell>{dataset, category, model, summaries.front().n});
                     for (const Summary& summary : summaries)
                       cells.insert(cells.end(), {summary.mean, (summary.ci_high - summary.ci_low) / 2});
                   });
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
