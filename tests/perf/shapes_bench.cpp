// SPDX-License-Identifier: GPL-3.0-or-later
// The stages on a sphere, and on one with a stray point at 10,000 radii; on real meshes of four sizes, on one
// scan of each, and on a subdivided mesh of up to a million vertices:
//
//   SALBENCH_DATA=DATA build/release/bench_shapes [--threads=N] [--benchmark_filter=LS]
//
// Single-threaded by default; rejections follow the time, with the reason. Times are those of the process:
// with N threads, "Time" falls and "CPU" stays.
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>

#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include "stages/core/errors.h"
#include "stages/descriptors/fpfh.h"
#include "stages/models/cs.h"
#include "stages/models/floors.h"
#include "stages/models/lce.h"
#include "stages/models/ls.h"
#include "stages/models/lvj.h"
#include "stages/models/ms.h"
#include "stages/models/ps.h"
#include "stages/models/vis.h"
#include "stages/normals/normals.h"
#include "stages/scan/scan.h"
#include "stages/surface/surface.h"
#include "tests/perf/shapes.h"
#include "tests/support/data.h"

namespace salbench {
namespace {

template <class Stage>
void add(const std::string& stage, const std::string& shape, const Source& source, Stage&& run,
         bool of_scan = false) {
  benchmark::RegisterBenchmark((stage + "/" + shape).c_str(),
                               [=](benchmark::State& state) {
                                 Shape& on = shape_of(source);
                                 if (of_scan) on.add_scan();
                                 for (auto _ : state) try {
                                     benchmark::DoNotOptimize(run(on));
                                   } catch (const InputError& refused) {
                                     state.SetLabel(refused.what());
                                   }
                                 state.counters["points"] = static_cast<double>(
                                     of_scan ? on.scan->points.size() : on.mesh.vertices.size());
                               })
      ->Unit(benchmark::kMillisecond)
      ->MeasureProcessCPUTime()
      ->UseRealTime();
}

void add_of_mesh(const std::string& name, const Source& source) {
  add("normals", name, source, [](const Shape& s) { return mesh_normals(s.mesh); });
  add("FPFH", name, source, [](const Shape& s) { return fpfh(s.mesh.vertices, s.normals, FpfhOptions{}); });
  add("LS", name, source,
      [](const Shape& s) { return ls_saliency(s.mesh.vertices, s.normals, s.descriptors, LsOptions{}); });
  add("CS", name, source,
      [](const Shape& s) { return cs_saliency(s.mesh.vertices, s.normals, CsOptions{}); });
  add("PS", name, source,
      [](const Shape& s) { return ps_saliency(s.mesh.vertices, s.descriptors, PsOptions{}); });
  add("MS", name, source,
      [](const Shape& s) { return ms_saliency(s.mesh.vertices, s.mesh.faces, MsOptions{}); });
  add("MC", name, source,
      [](const Shape& s) { return mc_saliency(s.mesh.vertices, s.mesh.faces, McOptions{}); });
  add("LVJ", name, source,
      [](const Shape& s) { return lvj_saliency(s.mesh.vertices, s.mesh.faces, LvjOptions{}); });
  add("LCE", name, source,
      [](const Shape& s) { return lce_saliency(s.mesh.vertices, s.mesh.faces, LceOptions{}); });
  add("VIS", name, source,
      [](const Shape& s) { return vis_saliency(s.mesh.vertices, s.normals, s.mesh.faces, VisOptions{}); });
  add("NV", name, source,
      [](const Shape& s) { return nv_saliency(s.mesh.vertices, s.normals, NvOptions{}); });
}

// All scans of the mesh, with their common scene.
std::size_t count_scanned(const Mesh& mesh) {
  const ScanScene scene(mesh);
  std::size_t points = 0;
  for (int view = 0; view < kViews; ++view) points += scene.scan(view).points.size();
  return points;
}

void add_of_scan(const std::string& name, const Source& source) {
  add("scans", source.name, source, [](const Shape& s) { return count_scanned(s.mesh); });
  add(
      "normals", name, source, [](const Shape& s) { return scan_normals(*s.scan); }, true);
  add(
      "surface", name, source, [](const Shape& s) { return partial_mesh(s.scan->points, s.scan_normals); },
      true);
  add(
      "FPFH", name, source,
      [](const Shape& s) { return fpfh(s.scan->points, s.scan_normals, ScanFpfhOptions{}); }, true);
  add(
      "LS", name, source,
      [](const Shape& s) {
        return ls_saliency(s.scan->points, s.scan_normals, s.scan_descriptors, LsOptions{}.of_scans());
      },
      true);
  add(
      "CS", name, source,
      [](const Shape& s) { return cs_saliency(s.scan->points, s.scan_normals, CsOptions{}); }, true);
  add(
      "MS", name, source, [](const Shape& s) { return ms_saliency(s.scan->points, s.surface, MsOptions{}); },
      true);
  add(
      "MC", name, source, [](const Shape& s) { return mc_saliency(s.scan->points, s.surface, McOptions{}); },
      true);
  add(
      "LVJ", name, source,
      [](const Shape& s) { return lvj_saliency(s.scan->points, s.surface, LvjOptions{}); }, true);
  add(
      "LCE", name, source,
      [](const Shape& s) { return lce_saliency(s.scan->points, s.surface, LceOptions{}); }, true);
  add(
      "VIS", name, source,
      [](const Shape& s) { return vis_saliency(s.scan->points, s.scan_normals, s.surface, VisOptions{}); },
      true);
}

void register_spheres() {
  add_of_mesh("sphere", {.name = "sphere"});
  add_of_mesh("sphere_with_stray", {.name = "sphere_with_stray", .stray = 1e4});
}

void register_real(const std::filesystem::path& data) {
  const MeshesBySize meshes = meshes_by_size(data);
  for (const std::size_t n : {2'000, 5'000, 10'000, 27'000}) {
    const Source source = mesh_of_size(meshes, n);
    add_of_mesh(source.name, source);
    add_of_scan(source.name + "_0", source);
  }
  Source source = mesh_of_size(meshes, 15'625);  // 4^3 of these are a million
  for (const unsigned int times : {1U, 2U, 3U}) {
    source.subdivisions = times;
    add_of_mesh(source.file.stem().string() + ":subdivided" + std::to_string(times), source);
  }
}

}  // namespace
}  // namespace salbench

int main(int argc, char** argv) {
  std::size_t threads = 1;
  const char* const option = "--threads=";
  const auto given = std::find_if(argv + 1, argv + argc, [&](const char* a) {
    return std::strncmp(a, option, std::strlen(option)) == 0;
  });
  if (given != argv + argc) {
    std::from_chars(*given + std::strlen(option), *given + std::strlen(*given), threads);
    std::rotate(given, given + 1, argv + argc);
    --argc;
  }
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  std::max<std::size_t>(threads, 1));
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  salbench::register_spheres();
  if (const auto data = salbench::real_data())
    salbench::register_real(*data);
  else
    std::fprintf(stderr, "bench_shapes: spheres alone: %s\n", salbench::kNoRealData);
  benchmark::RunSpecifiedBenchmarks();
}
