// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/results.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "io/file.h"
#include "pipeline/results/conclusions.h"
#include "pipeline/results/human_curves.h"
#include "pipeline/results/table_rows.h"
#include "stages/core/check.h"

namespace salbench {

namespace fs = std::filesystem;

namespace {

ResultRow result_row(const Context& context, const JobRef& job, Scores scores) {
  const DatasetItem& source = context.source(job.item);
  const std::string& stage = context.row(job).name;
  return {std::string(name_of(job.item.shapes())),
          source.name,
          source.category,
          job.item.is_scan() ? std::to_string(job.item.view) : "",
          stage.substr(stage.find('.') + 1),
          std::move(scores),
          job};
}

std::vector<ResultRow> collect(const RunState& run, bool of_constant) {
  struct Scored {
    std::size_t row;  // of the scores that the table is made of
    ValuePtr table;
    std::size_t taken = 0;  // rows of the table
  };
  const Catalog& catalog = run.context.catalog;
  std::vector<Scored> scored;
  for (std::size_t row = 0; row < catalog.rows.size(); ++row)
    if (catalog.rows[row].kind == "score_table" &&
        catalog.rows[row].name.ends_with(fmt::format(".{}", kConstantMap)) == of_constant)
      scored.push_back({catalog.rows[row].inputs[0], run.runner.result_so_far({row, Item::set()})});

  std::vector<ResultRow> rows;
  for (const Item& item : all_items(run.context))
    for (auto& [row, table, taken] : scored) {
      const JobRef job{row, item};
      if (run.context.row(job).scope() == item.scope() && run.plan[job].known())
        rows.push_back(result_row(run.context, job, std::get<ScoreTable>(*table).rows.at(taken++)));
    }
  return rows;
}

// bin_left, then a column for the ground truth (GS) and each model: mean 100-bin density histograms of the
// unmatched, min-max-normalised maps. [tasse2016]
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

}  // namespace

std::vector<ResultRow> collect_results(const RunState& run) { return collect(run, false); }

std::vector<ResultRow> collect_constant(const RunState& run) { return collect(run, true); }

Table results_table(const std::vector<ResultRow>& rows, const Metrics& metrics) {
  Table table{.columns = {"dataset", "item", "class", "view", "model"}, .rows = {}};
  for (const Metric& metric : metrics) table.columns.push_back(metric.name);
  table.columns.insert(table.columns.end(), {"n_points", "n_picks"});
  for (const ResultRow& row : rows) {
    CHECK_EQ(row.scores.values.size(), metrics.size());
    table.rows.push_back(cells(row.dataset, row.item, row.category, row.view, row.model,
                               std::vector<Cell>(row.scores.values.begin(), row.scores.values.end()),
                               row.scores.n_points, row.scores.n_picks));
  }
  return table;
}

void prepare_output(const fs::path& folder) {
  make_folder(folder, "choose another with --out");
  visit_abandoned(folder, [](const fs::path& file) { fs::remove(file); });
  write_file(folder / "run.yaml", "# a run is under way, or was ended before its end\n");
}

void write_tables(const fs::path& folder, const RunState& run, const std::vector<ResultRow>& rows,
                  const Conclusions& conclusions, const std::vector<std::string>& remarks) {
  std::string head;
  for (const std::string& remark : remarks) head += fmt::format("# {}\n", remark);
  const auto write = [&](const std::string& name, const Table& table) {
    write_file(folder / name, head + to_csv(table));
  };
  const Metrics& metrics = conclusions.metrics;
  write("results.csv", results_table(rows, metrics));
  write_conclusions(folder, rows, conclusions, head);
  // Tables of an earlier run would pass for some of this.
  for (const Shapes shapes : kAllShapes) {
    const std::string name = fmt::format("mean_histograms_{}.csv", name_of(shapes));
    if (shapes == Shapes::clouds && !run.context.catalog.has(shapes, "cloud"))
      remove_file(folder / name);
    else
      write(name, mean_histogram_table(run, shapes));
  }
  write_human_curves(folder, collect_human_curves(run), rows, conclusions, head);
}

}  // namespace salbench
