// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/results.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "io/file.h"
#include "pipeline/results/raw_tables.h"
#include "pipeline/results/table_rows.h"
#include "stages/core/check.h"

namespace salbench {

namespace fs = std::filesystem;

namespace {

// Number of a scan, behind the view of the ground truth that it was given, if that is scored by itself.
std::string view_of(const Units& units, Unit unit) {
  const std::string& view = item_of(units, unit).view;
  if (unit.level != kScans) return view;
  return fmt::format("{}{}{}", view, view.empty() ? "" : "_", units.place(unit));
}

// Tables of one kind, with as many rows for each shape, of which one is taken.
struct Taken {
  Role role = Role::score_table;
  bool of_constant = false;
  std::size_t rows_per_shape = 1, row = 0;
};

std::vector<ResultRow> collect(const RunState& run, const Taken& taken_rows) {
  struct Scored {
    std::size_t scores;  // the rule that the table is made of
    ValuePtr table;
    std::size_t shapes = 0;  // taken so far
  };
  const Rules& rules = run.project().rules;
  std::vector<Scored> scored;
  for (std::size_t r = 0; r < rules.size(); ++r)
    if (has_role(rules[r], taken_rows.role) && (rules[r].subject == kConstantMap) == taken_rows.of_constant)
      scored.push_back({rules[r].inputs[0], run.resolver.value_so_far({r, Unit{}})});

  Metrics metrics = chosen_metrics(run.config.metrics);
  if (taken_rows.of_constant) std::erase_if(metrics, [](const Metric& of) { return !of.constant_varies; });
  std::vector<ResultRow> rows;
  for (const Unit unit : run.shapes())
    for (auto& [rule, table, shapes] : scored) {
      const Job job{rule, unit};
      if (rules[rule].over != unit.level || !run.decision(job).known()) continue;
      const DatasetItem& item = item_of(run.units(), unit);
      const std::size_t row = shapes++ * taken_rows.rows_per_shape + taken_rows.row;
      rows.push_back({std::string(shapes_name(unit.level)), item.shape_name(), item.category,
                      view_of(run.units(), unit), rules[rule].subject,
                      in_range(metrics, value_as<ScoreTable>(*table).rows.at(row)), job, item.split});
    }
  return rows;
}

// bin_left, then a column for the ground truth (GS) and each model: mean 100-bin density histograms of the
// unmatched, min-max-normalised maps. [tasse2016]
Table mean_histogram_table(const RunState& run, Level level) {
  Table table{.columns = {"bin_left"}, .rows = std::vector<std::vector<Cell>>(kHistogramBins)};
  for (std::size_t bin = 0; bin < kHistogramBins; ++bin)
    table.rows[bin].emplace_back(static_cast<double>(bin) / kHistogramBins);
  for (const Job& job : run.project().jobs_of(Unit{})) {
    const Rule& rule = run.project().rule(job);
    const bool is_reference = has_role(rule, Role::reference);
    if ((!is_reference && !has_role(rule, Role::mean_histogram)) || rule.over != level ||
        !run.decision(job).known())
      continue;
    table.columns.push_back(is_reference ? "GS" : rule.subject);
    const ValuePtr histogram = run.resolver.value(job);
    for (std::size_t bin = 0; bin < kHistogramBins; ++bin)
      table.rows[bin].emplace_back(value_as<Histogram>(*histogram)[bin]);
  }
  return table;
}

std::vector<std::string> result_columns(bool in_splits, const Metrics& metrics) {
  std::vector<std::string> columns = {"dataset", "item", "class", "view", "model"};
  if (in_splits) columns.insert(columns.begin() + 1, "split");
  for (const Metric& metric : metrics) columns.push_back(metric.name);
  columns.insert(columns.end(), {"n_points", "n_picks"});
  return columns;
}

std::vector<Cell> result_cells(const ResultRow& row, bool in_splits, const Metrics& metrics) {
  CHECK_EQ(row.scores.values.size(), metrics.size());
  std::vector<Cell> dataset = {row.dataset};
  if (in_splits) dataset.emplace_back(row.split);
  return cells(dataset, row.item, row.category, row.view, row.model,
               std::vector<Cell>(row.scores.values.begin(), row.scores.values.end()), row.scores.n_points,
               row.scores.n_picks);
}

// to_csv(results_table(...)), without the cells of all rows at once: six times the memory of their text.
std::string results_text(const std::vector<ResultRow>& rows, const Metrics& metrics) {
  const bool in_splits = any_in_splits(rows);
  std::string text = to_csv({.columns = result_columns(in_splits, metrics), .rows = {}});
  for (const ResultRow& row : rows) append_csv_line(text, result_cells(row, in_splits, metrics));
  return text;
}

}  // namespace

std::vector<Unit> RunState::shapes() const {
  std::vector<Unit> shapes;
  for (std::size_t family = 0; family < units().families().size(); ++family)
    for (const Unit unit : units().of_family(family))
      if (units().is_chosen(unit) &&
          std::ranges::any_of(project().rules, [&](const Rule& rule) { return rule.level() == unit.level; }))
        shapes.push_back(unit);
  return shapes;
}

bool any_in_splits(const std::vector<ResultRow>& rows) {
  return std::ranges::any_of(rows, [](const ResultRow& row) { return !row.split.empty(); });
}

std::vector<ResultRow> collect_results(const RunState& run) { return collect(run, {}); }

std::vector<ResultRow> collect_smoothed(const RunState& run, std::size_t k) {
  return collect(
      run, {.role = Role::smoothed_table, .rows_per_shape = run.config.metrics.smoothing.size(), .row = k});
}

std::vector<ResultRow> collect_constant(const RunState& run) { return collect(run, {.of_constant = true}); }

Table results_table(const std::vector<ResultRow>& rows, const Metrics& metrics) {
  const bool in_splits = any_in_splits(rows);
  Table table{.columns = result_columns(in_splits, metrics), .rows = {}};
  for (const ResultRow& row : rows) table.rows.push_back(result_cells(row, in_splits, metrics));
  return table;
}

std::vector<std::string> training_remarks(const RunState& run) {
  std::vector<std::string> remarks;
  for (const Model& model : run.config.models) {
    std::vector<std::string> seen;
    std::size_t scored = 0;
    for (const Family& family : run.units().families()) {
      const DatasetItem& item = item_of(family.source);
      if (!family.chosen || !(item.has_truth() || run.config.simulated())) continue;
      ++scored;
      if (std::ranges::any_of(model.trained_on, [&](const std::string& name) {
            return name == item.name || name == item.shape_name() || is_in_split(item.split, name);
          }))
        seen.push_back(item.name);
    }
    if (seen.empty()) continue;
    constexpr std::size_t kNamed = 5;
    const std::string more = seen.size() > kNamed ? fmt::format(" and {} more", seen.size() - kNamed) : "";
    seen.resize(std::min(seen.size(), kNamed));
    remarks.push_back(
        fmt::format("{} was trained on shapes that it is scored on here ({}{}; {} scored): its scores there "
                    "do not say how it does on new shapes.",
                    model.name, fmt::join(seen, ", "), more, scored));
  }
  return remarks;
}

void prepare_output(const fs::path& folder) {
  make_folder(folder, "choose another with " + as_option("out"));
  visit_abandoned(folder, [](const fs::path& file) { fs::remove(file); });
  write_file(folder / "run.yaml", "# a run is under way, or was ended before its end\n");
}

std::vector<TableFile> table_files(const RunState& run, const std::vector<ResultRow>& rows,
                                   const std::vector<std::string>& remarks) {
  std::string head;
  for (const std::string& remark : remarks) head += fmt::format("# {}\n", remark);
  const auto text = [&](const Table& table) { return head + to_csv(table); };
  const MetricsOptions& options = run.config.metrics;
  const Metrics metrics = chosen_metrics(options);
  std::vector<TableFile> files = {
      {"results.csv", head + results_text(rows, metrics)},
      {"means.csv", text(means_table(rows, metrics))},
      {"constant.csv", head + results_text(rows_of_constant(rows, collect_constant(run), options), metrics)},
      {"people.csv"},
      {"smoothed.csv"},
      {.name = "fitted.csv", .is_of_scores = false}};
  if (const std::vector<MeshCurve> curves = collect_human_curves(run); !curves.empty())
    files[3].text = text(people_table(curves, metrics));
  if (!options.smoothing.empty()) files[4].text = text(smoothed_table(run, metrics));
  if (const Table fitted = fitted_table(run); !fitted.rows.empty()) files[5].text = text(fitted);
  for (const Level level : kShapeLevels) {
    TableFile& file = files.emplace_back(fmt::format("mean_histograms_{}.csv", shapes_name(level)));
    file.is_of_scores = false;
    if (level != kClouds || run.inputs.has(level)) file.text = text(mean_histogram_table(run, level));
  }
  return files;
}

}  // namespace salbench
