// SPDX-License-Identifier: GPL-3.0-or-later
// The stages beside libraries that do the same work, on the same shapes and in the same program:
//
//   SALBENCH_DATA=DATA build/release/bench_peers [--benchmark_filter=FPFH]
//
// A name is WORK/SIDE/MESH, the side "ours" or a library; peers.h says what each library leaves out. One
// thread; "size" is how many points, faces or pairs came out. scripts/peers prints the ratios.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include "stages/core/mesh_ops.h"
#include "stages/fpfh/fpfh.h"
#include "stages/models/chi2_kernel.h"
#include "stages/models/chi_square.h"
#include "stages/models/ms.h"
#include "stages/models/simplified.h"
#include "stages/normals/normals.h"
#include "stages/scan/scan.h"
#include "stages/surface/surface.h"
#include "tests/perf/peers.h"
#include "tests/perf/shapes.h"
#include "tests/support/data.h"

namespace salbench {
namespace {

using peers::Work;

constexpr double kRadius = 0.1;  // in R, of the high level of LS
const std::size_t kFewFaces = static_cast<std::size_t>(MsOptions().faces);

// The scene is built each time, as it is once per mesh of a run.
Work our_scans(const Shape& shape, int views) {
  return [&mesh = shape.mesh, views] {
    const ScanScene scene(mesh);
    std::size_t count = 0;
    for (int view = 0; view < views; ++view) count += scene.scan(view).points.size();
    return count;
  };
}

// The groups of Chi2Table, without their boxes: every pair is looked at.
Work our_chi_squares(const Shape& shape) {
  namespace kernel = chi2_kernel;
  const Descriptors& descriptors = shape.descriptors;
  const std::vector<std::size_t> bins = used_bins(descriptors);
  std::vector<std::int32_t> groups(kernel::groups_of(descriptors.size()));
  std::iota(groups.begin(), groups.end(), 0);
  std::vector<float> rows, table(groups.size() * bins.size() * kernel::kLanes);
  for (std::size_t i = 0; i < descriptors.size(); ++i)
    for (std::size_t b = 0; b < bins.size(); ++b) {
      rows.push_back(descriptors.row(i)[bins[b]]);
      table[(i / kernel::kLanes * bins.size() + b) * kernel::kLanes + i % kernel::kLanes] = rows.back();
    }
  return [n = descriptors.size(), n_bins = bins.size(), groups, rows, table,
          distances = std::vector<float>(groups.size() * kernel::kLanes)]() mutable {
    const kernel::Kernel& widest = kernel::kernel();
    for (std::size_t query = 0; query < peers::kQueries; ++query) {
      widest.distances(table.data(), n_bins, rows.data() + query * n / peers::kQueries * n_bins,
                       groups.data(), groups.size(), distances.data());
      benchmark::DoNotOptimize(distances.data());
      benchmark::ClobberMemory();
    }
    return peers::kQueries * n;
  };
}

struct Side {
  std::string name;
  std::function<Work(const Shape&)> prepare;
};

void add(const std::string& work, const Source& source, const std::vector<Side>& sides) {
  for (const Side& side : sides)
    benchmark::RegisterBenchmark((work + "/" + side.name + "/" + source.name).c_str(),
                                 [=](benchmark::State& state) {
                                   Shape& shape = shape_of(source);
                                   shape.add_scan();
                                   try {
                                     const Work once = side.prepare(shape);
                                     std::size_t size = 0;
                                     for (auto _ : state) benchmark::DoNotOptimize(size = once());
                                     state.counters["size"] = static_cast<double>(size);
                                   } catch (const std::exception& error) {
                                     state.SkipWithError(error.what());
                                   }
                                 })
        ->Unit(benchmark::kMillisecond)
        ->MeasureProcessCPUTime();
}

// `run(shape)` returns what has a size().
template <class Run>
Side ours(Run&& run) {
  return {"ours", [=](const Shape& shape) -> Work { return [=, &shape] { return run(shape).size(); }; }};
}

void add_descriptors(const Source& source) {
  const auto within = [](const Shape& s) { return kRadius * bounding_radius(s.mesh.vertices); };
  add("FPFH of 9 nearest points", source,
      {ours([](const Shape& s) { return fpfh(s.mesh.vertices, s.normals, {.neighbours = 9}); }),
       {"PCL", [](const Shape& s) { return peers::pcl_fpfh(s, {.neighbours = 9}); }}});
  add("FPFH within 0.1 R", source,
      {ours([](const Shape& s) {
         return fpfh(s.mesh.vertices, s.normals,
                     {.neighbourhood = FpfhNeighbourhood::radius, .radius = kRadius, .grow = false});
       }),
       {"PCL", [=](const Shape& s) { return peers::pcl_fpfh(s, {.radius = within(s)}); }}});
  add("chi-square distances", source, {{"ours", our_chi_squares}, {"FLANN", peers::flann_chi_squares}});
}

void add_scans(const Source& source) {
  add("scan", source,
      {{"ours", [](const Shape& s) { return our_scans(s, 1); }},
       {"Embree", [](const Shape& s) { return peers::embree_scans(s, 1); }}});
  add("scans of all views", source,
      {{"ours", [](const Shape& s) { return our_scans(s, kViews); }},
       {"Embree", [](const Shape& s) { return peers::embree_scans(s, kViews); }}});
  const ScanNormalsOptions camera, hoppe = ScanNormalsOptions::text();
  add("normals to the camera", source,
      {ours([](const Shape& s) { return scan_normals(*s.scan); }),
       {"PCL", [=](const Shape& s) { return peers::pcl_normals(s, camera.neighbours); }}});
  add("normals by Hoppe's tree", source,
      {ours([=](const Shape& s) { return scan_normals(*s.scan, hoppe); }),
       {"CGAL", [=](const Shape& s) { return peers::cgal_normals(s, hoppe); }}});
  add("partial mesh", source,
      {ours([](const Shape& s) { return partial_mesh(s.scan->points, s.scan_normals); }),
       {"PCL", [](const Shape& s) { return peers::pcl_surface(s, {}); }}});
}

void add_simplification(const Source& source) {
  std::vector<Side> sides = {ours([](const Shape& s) { return simplified(s.mesh, kFewFaces).faces; }),
                             {"CGAL", [](const Shape& s) { return peers::cgal_simplified(s, kFewFaces); }}};
#ifdef SALBENCH_MESHOPTIMIZER
  sides.push_back(
      {"meshoptimizer", [](const Shape& s) { return peers::meshoptimizer_simplified(s, kFewFaces); }});
#endif
  add("simplification", source, sides);
}

void register_all(const std::filesystem::path& data) {
  const MeshesBySize meshes = meshes_by_size(data);
  for (const std::size_t n : {5'000, 10'000, 27'000}) {
    const Source source = mesh_of_size(meshes, n);
    add_descriptors(source);
    add_scans(source);
    add_simplification(source);
  }
}

}  // namespace
}  // namespace salbench

int main(int argc, char** argv) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  const auto data = salbench::real_data();
  if (!data) {
    std::fprintf(stderr, "bench_peers: %s\n", salbench::kNoRealData);
    return 2;
  }
  salbench::register_all(*data);
  benchmark::RunSpecifiedBenchmarks();
}
