#include "pipeline/results.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "io/file.h"
#include "pipeline/given_maps.h"
#include "pipeline/statistics.h"
#include "stages/core/errors.h"
#include "stages/metrics/metrics.h"
#include "stages/stats/summary.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

std::string host_name() {
  char name[256] = {};
  ::gethostname(name, sizeof name - 1);
  return name;
}

std::string_view reference_line(const Context& context) {
  if (context.given_reference) return "given by --reference";
  return context.shard ? "none, the run was over a share of the items" : "mean over the items of the run";
}

std::string run_yaml(const RunRecord& record) {
  std::string yaml;
  if (record.config.simulated()) yaml += fmt::format("# {}\n", kSimulatedNote);
  yaml += fmt::format(
      "program: salbench {}\nhost: {}\nthreads: {}\nseconds: {:.3f}\nartefacts_computed: {}\n",
      SALBENCH_VERSION, yaml_quoted(host_name()), record.threads, record.seconds, record.runner.computed());
  if (record.context.shard) yaml += fmt::format("shard: {}\n", record.context.shard->text());
  yaml += fmt::format("reference: {}\n", reference_line(record.context));
  for (const Model& model : record.config.models)
    if (model.given)
      yaml += fmt::format("evaluated: {{model: {}, maps: {}, matched: {}}}\n", model.name,
                          yaml_quoted(model.given->source.string()), model.given->matched);
  const DataIdentity data = identity_of(record.context.workload);
  yaml += fmt::format("data_set: {{folder: {}, layout: {}, meshes: {}, files: {}, digest: {}}}\n",
                      yaml_quoted(record.config.data), record.context.workload.layout,
                      record.context.workload.families.size(), data.files, data.digest.hex());
  yaml +=
      "stages:  # version, artefacts this run computed, seconds summed over threads, reasons with counts\n";
  for (const StageCount& count : count_by_stage(record.context, record.plan, record.why)) {
    const auto timing = record.runner.timings().find(count.stage);
    const StageTiming spent = timing == record.runner.timings().end() ? StageTiming{} : timing->second;
    std::string why;
    for (const auto& [reason, n] : count.reasons)
      why += fmt::format("{}{}: {}", why.empty() ? "" : ", ", yaml_quoted(reason), n);
    yaml += fmt::format("  {}: {{version: {}, computed: {}, seconds: {:.3f}, why: {{{}}}}}\n", count.stage,
                        count.version, spent.computed, spent.seconds, why);
  }
  yaml += record.runner.failures().empty() ? "failed: []\n" : "failed:\n";
  for (const Failure& failure : record.runner.failures())
    yaml += fmt::format("  - {{item: {}, stage: {}, cause: {}}}\n",
                        yaml_quoted(record.context.name(failure.item)), failure.stage,
                        yaml_quoted(failure.cause));
  yaml += "configuration:\n";
  std::string line;
  for (const char c : config_yaml(record.config)) {
    line += c;
    if (c != '\n') continue;
    yaml += "  " + line;
    line.clear();
  }
  return yaml;
}

}  // namespace

std::vector<DatasetAndModel> datasets_and_models(const std::vector<ResultRow>& rows) {
  std::vector<DatasetAndModel> pairs;
  for (const char* dataset : {"meshes", "scans"})
    for (const ResultRow& row : rows)
      if (const DatasetAndModel pair{row.dataset, row.model};
          row.dataset == dataset && std::find(pairs.begin(), pairs.end(), pair) == pairs.end())
        pairs.push_back(pair);
  return pairs;
}

std::vector<ResultRow> collect_results(const Config& config, const Context& context, const Plan& plan,
                                       Runner& runner) {
  std::vector<ResultRow> rows;
  Progress& progress = runner.progress();
  progress.begin("collecting scores", context.workload.families.size());
  for (std::size_t f = 0; f < context.workload.families.size(); ++f) {
    for (const ItemRef& item : context.family(f)) {
      const Chain& chain = context.chain(item);
      for (const Model& model : config.models) {
        const std::string name = "scores." + model.name;
        if (!has_stage(chain, name)) continue;
        const std::size_t stage = stage_index(chain, name);
        if (!plan.jobs(item)[stage].known()) continue;
        rows.push_back({item.is_mesh() ? "meshes" : "scans", context.source(item).name,
                        context.source(item).category, item.is_mesh() ? "" : std::to_string(item.view),
                        model.name, std::get<Scores>(runner.result(item, stage))});
      }
    }
    progress.item_done();
  }
  progress.end();
  return rows;
}

std::vector<HumanCurve> collect_human_curves(const Config& config, const Context& context, const Plan& plan,
                                             Runner& runner) {
  std::vector<HumanCurve> curves;
  const Chain& chain = context.catalog.mesh;
  for (const Model& model : config.models) {
    const std::string name = "curve." + model.name;
    if (!has_stage(chain, name)) continue;
    const std::size_t stage = stage_index(chain, name);
    for (const ItemRef& item : context.items(true))
      if (plan.jobs(item)[stage].known()) curves.push_back(std::get<HumanCurve>(runner.result(item, stage)));
  }
  return curves;
}

Table results_table(const std::vector<ResultRow>& rows) {
  Table table{.columns = {"dataset", "item", "class", "view", "model"}, .rows = {}};
  for (const Metric& metric : metric_table()) table.columns.emplace_back(metric.name);
  table.columns.insert(table.columns.end(), {"n_points", "n_picks"});
  for (const ResultRow& row : rows) {
    auto& cells =
        table.rows.emplace_back(std::vector<Cell>{row.dataset, row.item, row.category, row.view, row.model});
    for (const Metric& metric : metric_table()) cells.emplace_back(value_of(row.scores, metric.name));
    cells.insert(cells.end(), {row.scores.n_points, row.scores.n_picks});
  }
  return table;
}

Table summary_table(const std::vector<ResultRow>& rows) {
  Table table{.columns = {"dataset", "model", "metric", "n", "mean", "sd", "ci95_low", "ci95_high"},
              .rows = {}};
  for (const auto& [dataset, model] : datasets_and_models(rows)) {
    for (const Metric& metric : metric_table()) {
      std::vector<double> values;
      for (const ResultRow& row : rows)
        if (row.dataset == dataset && row.model == model) values.push_back(value_of(row.scores, metric.name));
      const Summary summary = summarize(values);
      table.rows.push_back({dataset, model, std::string(metric.name), summary.n, summary.mean, summary.sd,
                            summary.ci_low, summary.ci_high});
    }
  }
  return table;
}

// Densities over [0, 1] sum to the number of their bins; a column that sums to anything else, such as
// probabilities, is of the same shape, and shape is what it stands for.
Histogram read_reference(const std::string& path) {
  constexpr double kRounded = 1e-3;  // of the sum: a density that was written with few digits
  const Table table = read_csv(path);
  const std::vector<double> column = number_column(table, "GS");
  Histogram histogram{};
  if (column.size() != histogram.size())
    throw ConfigError(
        fmt::format("{}: column GS has {} rows, expected {} bins", path, column.size(), histogram.size()));
  for (std::size_t i = 0; i < histogram.size(); ++i) {
    histogram[i] = column[i];
    if (!std::isfinite(column[i]) || column[i] < 0)
      throw ConfigError(fmt::format("{}:{}: column GS holds {}, expected a density, finite and not negative",
                                    path, table.lines[i], column[i]));
  }
  const double sum = std::accumulate(column.begin(), column.end(), 0.0);
  if (!(sum > 0) || !std::isfinite(sum))
    throw ConfigError(fmt::format("{}:{}: column GS sums to {:.6g} from here on: no density does", path,
                                  table.lines.front(), sum));
  if (!table.remark.empty()) spdlog::warn("{}: {}", path, table.remark);
  const auto bins = static_cast<double>(histogram.size());
  if (std::abs(sum / bins - 1) <= kRounded) return histogram;
  spdlog::warn("{}: column GS sums to {:.6g}, densities over {} bins to {}: it was scaled", path, sum, bins,
               bins);
  for (double& density : histogram) density = density / sum * bins;
  return histogram;
}

void prepare_output(const fs::path& folder) {
  make_folder(folder, "choose another with --out");
  visit_abandoned(folder, [](const fs::path& file) { fs::remove(file); });
  write_file(folder / "run.yaml", "# a run is under way, or was ended before its end\n");
}

void write_shard_record(const fs::path& folder, const RunRecord& record) {
  const Shard& shard = *record.context.shard;
  write_file(folder / fmt::format("shard_{}_of_{}.yaml", shard.index, shard.count), run_yaml(record));
}

void write_results(const fs::path& folder, const RunRecord& record, const std::vector<ResultRow>& rows) {
  const std::string head = record.config.simulated() ? fmt::format("# {}\n", kSimulatedNote) : "";
  const auto write = [&](const char* name, const Table& table) {
    write_file(folder / name, head + to_csv(table));
  };
  write("results.csv", results_table(rows));
  write("summary.csv", summary_table(rows));
  write("per_class.csv", per_class_table(rows));
  write("significance.csv", significance_table(rows));
  write("mean_histograms_meshes.csv", mean_histogram_table(record.context, record.runner, true));
  write("mean_histograms_scans.csv", mean_histogram_table(record.context, record.runner, false));
  const auto curves = collect_human_curves(record.config, record.context, record.plan, record.runner);
  std::error_code not_there;
  fs::remove(folder / "human_curve.csv", not_there);  // an earlier run's would pass for one of this
  if (!curves.empty()) write("human_curve.csv", human_curve_table(curves));
  write_file(folder / "run.yaml", run_yaml(record));
}

}  // namespace salbench
