// SPDX-License-Identifier: GPL-3.0-or-later
// Conclusions from scores of the size of the whole benchmark: 400 meshes, 12 scans of each, every metric.
// Arguments: models; unit (0: mesh, 1: class, 2: shape). peak_mb: of the process so far, rows included.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include "pipeline/results/conclusions.h"
#include "pipeline/results/pairs.h"
#include "stages/core/rng.h"

namespace salbench {
namespace {

constexpr int kMeshes = 400, kViews = 12, kMeshesPerClass = 20;

const Metrics& metrics() {
  static const Metrics all(metric_table().begin(), metric_table().end());
  return all;
}

std::vector<ResultRow> random_rows(int models) {
  Rng rng(1, "conclusions", "");
  std::vector<ResultRow> rows;
  for (int view = -1; view < kViews; ++view)
    for (int mesh = 0; mesh < kMeshes; ++mesh)
      for (int model = 0; model < models; ++model) {
        ResultRow& row = rows.emplace_back(ResultRow{view < 0 ? "meshes" : "scans",
                                                     std::to_string(mesh),
                                                     std::to_string(mesh / kMeshesPerClass),
                                                     view < 0 ? "" : std::to_string(view),
                                                     "M" + std::to_string(model),
                                                     {}});
        row.scores.values.resize(metrics().size());
        for (double& value : row.scores.values) value = rng.normal();
      }
  return rows;
}

void all_tables(benchmark::State& state) {
  const std::vector<ResultRow> rows = random_rows(static_cast<int>(state.range(0)));
  const StatisticsOptions options{.unit = static_cast<Observation>(state.range(1))};
  for (auto _ : state) {
    const Conclusions conclusions = conclude(rows, metrics(), options, 1);
    benchmark::DoNotOptimize(summary_table(conclusions));
    benchmark::DoNotOptimize(ranking_table(conclusions));
    benchmark::DoNotOptimize(agreement_table(conclusions));
    benchmark::DoNotOptimize(significance_table(conclusions));
    benchmark::DoNotOptimize(per_class_table(rows, metrics(), options.unit));
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  state.counters["peak_mb"] = static_cast<double>(usage.ru_maxrss) * 1024 / 1e6;
}
BENCHMARK(all_tables)
    ->ArgNames({"models", "unit"})
    ->ArgsProduct({{10}, {0, 1, 2}})
    ->Unit(benchmark::kSecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace salbench
