// SPDX-License-Identifier: GPL-3.0-or-later
// LS on a bumpy sphere with rough normals, one thread.
#include <string>

#include <benchmark/benchmark.h>
#include <hwy/highway.h>

#include "stages/fpfh/fpfh.h"
#include "stages/models/chi2_search.h"
#include "stages/models/ls.h"
#include "tests/support/shapes.h"

namespace salbench {
namespace {

struct Shape {
  std::vector<Vec3> points;
  Normals normals;
  Descriptors descriptors;

  // Any number of vertices of a fine sphere, spread evenly enough. Rough normals fill all bins of the
  // descriptors, as those of real shapes do.
  explicit Shape(std::size_t n) {
    const Mesh mesh = shapes::bumpy_sphere(6);
    const std::vector<Vec3> roughness = shapes::random_normals(n, 1);
    for (std::size_t i = 0; i < n; ++i) {
      points.push_back(mesh.vertices[i * mesh.vertices.size() / n]);
      normals.push_back((points.back().normalized() + 0.5 * roughness[i]).normalized());
    }
    descriptors = fpfh(points, normals, FpfhOptions{});
  }
};

void ls(benchmark::State& state, const LsOptions& options) {
  const Shape shape(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state)
    benchmark::DoNotOptimize(ls_saliency(shape.points, shape.normals, shape.descriptors, options));
  state.counters["pairs/s"] = benchmark::Counter(2.0 * static_cast<double>(state.range(0) * state.range(0)),
                                                 benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK_CAPTURE(ls, published, LsOptions{})
    ->Arg(5000)
    ->Arg(10000)
    ->Arg(20000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ls, text, LsOptions::text())->Arg(5000)->Arg(10000)->Unit(benchmark::kMillisecond);

void chi2_search(benchmark::State& state, std::int64_t instructions) {
  if ((hwy::SupportedTargets() & instructions) == 0) return state.SkipWithError("not on this machine");
  const Shape shape(static_cast<std::size_t>(state.range(0)));
  hwy::SetSupportedTargetsForTest(instructions);
  const Chi2Search search(shape.descriptors);
  hwy::SetSupportedTargetsForTest(0);
  for (auto _ : state)
    search.for_each(search.size() / 20, [](std::size_t, std::span<const Chi2Neighbour> nearest) {
      benchmark::DoNotOptimize(nearest.data());
    });
}
void add_searches() {
  for (const std::int64_t instructions : hwy::SupportedAndGeneratedTargets())
    benchmark::RegisterBenchmark((std::string("chi2_search/") + hwy::TargetName(instructions)).c_str(),
                                 chi2_search, instructions)
        ->Arg(10000)
        ->Unit(benchmark::kMillisecond);
}

}  // namespace
}  // namespace salbench

int main(int argc, char** argv) {
  salbench::add_searches();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
