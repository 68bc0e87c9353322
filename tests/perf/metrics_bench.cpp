// SPDX-License-Identifier: GPL-3.0-or-later
// All metrics of one map beside the paper's, one thread: a mesh of 10 000 vertices and a scan of 5 500
// points, picked as often as those of the Schelling study are.
#include <algorithm>
#include <cmath>

#include <benchmark/benchmark.h>

#include "stages/metrics/metrics.h"

namespace salbench {
namespace {

struct Example {
  ScalarField map, areas;
  GroundTruth truth;

  // A fifth of the points has ground truth; some points are picked by two or three of the 25 participants.
  Example(std::size_t n, std::size_t picks)
      : truth{ScalarField(n), std::vector<std::vector<std::int32_t>>(25)} {
    Rng rng(1, "metrics", "bench");
    for (std::size_t i = 0; i < n; ++i) {
      map.push_back(std::pow(rng.uniform(), 3));
      areas.push_back(0.1 + rng.uniform());
    }
    map[0] = 0;
    map[1] = 1;
    for (std::size_t k = 0; k < picks; ++k) {
      const std::size_t i = rng.below(rng.below(3) == 0 ? n / 50 : n / 5);
      truth.saliency[i] += rng.uniform();
      truth.picks[k % 25].push_back(static_cast<std::int32_t>(i));
    }
    for (std::size_t i = 0; i < n / 5; ++i) truth.saliency[i] += 0.1 * rng.uniform();
  }
};

void score_one_map(benchmark::State& state, bool all) {
  const Example example(static_cast<std::size_t>(state.range(0)), static_cast<std::size_t>(state.range(1)));
  const MetricsOptions options;
  std::vector<Metric> metrics = chosen_metrics(options);
  if (all) metrics.assign(metric_table().begin(), metric_table().end());
  for (auto _ : state)
    benchmark::DoNotOptimize(score(metrics, example.map, example.truth, options, Rng(1, "scores", "52"),
                                   example.areas, example.areas));
}
BENCHMARK_CAPTURE(score_one_map, papers, false)
    ->Args({10000, 450})
    ->Args({5500, 220})
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(score_one_map, all, true)
    ->Args({10000, 450})
    ->Args({5500, 220})
    ->Unit(benchmark::kMicrosecond);

// Each metric alone, with all that it does not share.
void one_metric(benchmark::State& state, const Metric& metric) {
  const Example example(10000, 450);
  for (auto _ : state)
    benchmark::DoNotOptimize(score({&metric, 1}, example.map, example.truth, {}, Rng(1, "scores", "52"),
                                   example.areas, example.areas));
}
const int registered = [] {
  for (const Metric& metric : metric_table())
    benchmark::RegisterBenchmark(("one_metric/" + metric.name).c_str(), one_metric, metric)
        ->Unit(benchmark::kMicrosecond);
  return 0;
}();

}  // namespace
}  // namespace salbench
