// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/results.h"

#include <algorithm>

#include <fmt/format.h>

#include "io/file.h"
#include "pipeline/results/statistics.h"
#include "stages/core/check.h"
#include "stages/stats/summary.h"

namespace salbench {

namespace fs = std::filesystem;

std::vector<DatasetAndModel> datasets_and_models(const std::vector<ResultRow>& rows) {
  std::vector<DatasetAndModel> pairs;
  for (const std::string_view dataset : EnumNames<Shapes>::names)
    for (const ResultRow& row : rows)
      if (const DatasetAndModel pair{row.dataset, row.model};
          row.dataset == dataset && std::find(pairs.begin(), pairs.end(), pair) == pairs.end())
        pairs.push_back(pair);
  return pairs;
}

ResultRow result_row(const Context& context, const Item& item, const std::string& model,
                     const Scores& scores) {
  const DatasetItem& source = context.source(item);
  return {std::string(name_of(item.shapes())),
          source.name,
          source.category,
          item.is_scan() ? std::to_string(item.view) : "",
          model,
          scores};
}

std::vector<ResultRow> collect_results(const RunState& run) {
  struct ScoresOf {
    std::string model;
    std::size_t row;
  };
  const Catalog& catalog = run.context.catalog;
  std::vector<ScoresOf> scored;
  for (const Model& model : run.config.models)
    for (const Shapes shapes : kAllShapes)
      if (const std::string name = "scores." + model.name; catalog.has(shapes, name))
        scored.push_back({model.name, catalog.index(shapes, name)});

  std::vector<ResultRow> rows;
  const std::vector<Item> items = all_items(run.context);
  run.runner.progress().begin("collecting scores", items.size());
  for (const Item& item : items) {
    for (const ScoresOf& of : scored) {
      const JobRef job{of.row, item};
      if (run.context.row(job).scope() == item.scope() && run.plan[job].known())
        rows.push_back(result_row(run.context, item, of.model, std::get<Scores>(*run.runner.result(job))));
    }
    run.runner.progress().item_done();
  }
  run.runner.progress().end();
  return rows;
}

Table results_table(const std::vector<ResultRow>& rows, const Metrics& metrics) {
  Table table{.columns = {"dataset", "item", "class", "view", "model"}, .rows = {}};
  for (const Metric& metric : metrics) table.columns.push_back(metric.name);
  table.columns.insert(table.columns.end(), {"n_points", "n_picks"});
  for (const ResultRow& row : rows) {
    CHECK_EQ(row.scores.values.size(), metrics.size());
    auto& cells =
        table.rows.emplace_back(std::vector<Cell>{row.dataset, row.item, row.category, row.view, row.model});
    cells.insert(cells.end(), row.scores.values.begin(), row.scores.values.end());
    cells.insert(cells.end(), {row.scores.n_points, row.scores.n_picks});
  }
  return table;
}

Table summary_table(const std::vector<ResultRow>& rows, const Metrics& metrics) {
  Table table{.columns = {"dataset", "model", "metric", "n", "mean", "sd", "ci95_low", "ci95_high"},
              .rows = {}};
  for (const auto& [dataset, model] : datasets_and_models(rows)) {
    for (std::size_t m = 0; m < metrics.size(); ++m) {
      std::vector<double> values;
      for (const ResultRow& row : rows)
        if (row.dataset == dataset && row.model == model) values.push_back(row.value(m));
      const Summary summary = summarise(values);
      table.rows.push_back({dataset, model, metrics[m].name, summary.n, summary.mean, summary.sd,
                            summary.ci_low, summary.ci_high});
    }
  }
  return table;
}

void prepare_output(const fs::path& folder) {
  make_folder(folder, "choose another with --out");
  visit_abandoned(folder, [](const fs::path& file) { fs::remove(file); });
  write_file(folder / "run.yaml", "# a run is under way, or was ended before its end\n");
}

void write_tables(const fs::path& folder, const RunState& run, const std::vector<ResultRow>& rows,
                  const std::vector<std::string>& remarks) {
  std::string head;
  for (const std::string& remark : remarks) head += fmt::format("# {}\n", remark);
  const auto write = [&](const std::string& name, const Table& table) {
    write_file(folder / name, head + to_csv(table));
  };
  const Metrics metrics = chosen_metrics(run.config.metrics);
  write("results.csv", results_table(rows, metrics));
  write("summary.csv", summary_table(rows, metrics));
  write("per_class.csv", per_class_table(rows, metrics));
  write("significance.csv", significance_table(rows, metrics));
  // Tables of an earlier run would pass for some of this.
  for (const Shapes shapes : kAllShapes) {
    const std::string name = fmt::format("mean_histograms_{}.csv", name_of(shapes));
    if (shapes == Shapes::clouds && !run.context.catalog.has(shapes, "cloud"))
      remove_file(folder / name);
    else
      write(name, mean_histogram_table(run, shapes));
  }
  const auto curves = collect_human_curves(run);
  remove_file(folder / "human_curve.csv");
  if (!curves.empty()) write("human_curve.csv", human_curve_table(curves, metrics));
}

}  // namespace salbench
