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
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <string>

#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include "io/shapes/mesh_file.h"
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
#include "tests/support/data.h"
#include "tests/support/shapes.h"
#include "tests/support/subdivided.h"

namespace salbench {
namespace {

struct Shape {
  Mesh mesh;  // a scan has its points and their partial mesh
  Normals normals;
  Descriptors descriptors;
  std::optional<Scan> scan = {};
};

struct Source {
  std::string name;                 // "20:15500": the file and its number of vertices
  std::filesystem::path file = {};  // empty: a sphere of 10,242 vertices
  unsigned int subdivisions = 0;
  double stray = 0;      // distance of a stray corner, in radii of the sphere
  bool is_scan = false;  // view 0 of the mesh
};

// Reads only the header, since there are hundreds of files: "OFF", then the number of vertices.
std::size_t vertices_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string word;
  std::size_t vertices = 0;
  stream >> word >> vertices;
  return vertices;
}

Mesh mesh_of(const Source& source) {
  if (!source.file.empty()) return subdivided(read_mesh(source.file), source.subdivisions);
  Mesh sphere = shapes::sphere(5);
  if (source.stray > 0) {
    sphere.faces.push_back({0, 1, static_cast<std::int32_t>(sphere.vertices.size())});
    sphere.vertices.emplace_back(source.stray, 0, 0);
  }
  return sphere;
}

Shape made(const Source& source) {
  Shape shape{mesh_of(source), {}, {}};
  if (source.is_scan) {
    shape.scan = simulate_scan(shape.mesh, 0);
    shape.normals = scan_normals(*shape.scan);
    shape.mesh = {shape.scan->points, partial_mesh(shape.scan->points, shape.normals)};
    shape.descriptors = fpfh(shape.mesh.vertices, shape.normals, ScanFpfhOptions{});
  } else {
    shape.normals = mesh_normals(shape.mesh);
    shape.descriptors = fpfh(shape.mesh.vertices, shape.normals, FpfhOptions{});
  }
  return shape;
}

// Made on first use. Of subdivided shapes only the last is kept, because of their size.
const Shape& shape_of(const Source& source) {
  static std::map<std::string, Shape> kept;
  if (const auto found = kept.find(source.name); found != kept.end()) return found->second;
  if (source.subdivisions > 0)
    std::erase_if(kept,
                  [](const auto& entry) { return entry.first.find("subdivided") != std::string::npos; });
  return kept.emplace(source.name, made(source)).first->second;
}

using MeshesBySize = std::map<std::size_t, std::filesystem::path>;  // number of vertices -> file

MeshesBySize meshes_by_size(const std::filesystem::path& data) {
  MeshesBySize meshes;
  for (const auto& entry : std::filesystem::directory_iterator(data / "SchellingData" / "Meshes"))
    meshes.emplace(vertices_of(entry.path()), entry.path());
  return meshes;
}

// Smallest mesh with at least `vertices`, or the largest of all.
Source mesh_of_size(const MeshesBySize& meshes, std::size_t vertices) {
  const auto at = meshes.lower_bound(vertices);
  const auto& [size, file] = at == meshes.end() ? *std::prev(at) : *at;
  return {file.stem().string() + ":" + std::to_string(size), file};
}

template <class Stage>
void add(const std::string& stage, const Source& source, Stage run) {
  benchmark::RegisterBenchmark((stage + "/" + source.name).c_str(),
                               [=](benchmark::State& state) {
                                 const Shape& shape = shape_of(source);
                                 for (auto _ : state) try {
                                     benchmark::DoNotOptimize(run(shape));
                                   } catch (const InputError& refused) {
                                     state.SetLabel(refused.what());
                                   }
                                 state.counters["points"] = static_cast<double>(shape.mesh.vertices.size());
                               })
      ->Unit(benchmark::kMillisecond)
      ->MeasureProcessCPUTime()
      ->UseRealTime();
}

void add_models(const Source& source) {
  const LsOptions ls = source.is_scan ? LsOptions{}.of_scans() : LsOptions{};
  add("LS", source,
      [=](const Shape& s) { return ls_saliency(s.mesh.vertices, s.normals, s.descriptors, ls); });
  add("CS", source, [](const Shape& s) { return cs_saliency(s.mesh.vertices, s.normals, {}); });
  add("PS", source, [](const Shape& s) { return ps_saliency(s.mesh.vertices, s.descriptors, {}); });
  add("MS", source, [](const Shape& s) { return ms_saliency(s.mesh.vertices, s.mesh.faces, {}); });
  add("MC", source, [](const Shape& s) { return mc_saliency(s.mesh.vertices, s.mesh.faces, {}); });
  add("LVJ", source, [](const Shape& s) { return lvj_saliency(s.mesh.vertices, s.mesh.faces, {}); });
  add("LCE", source, [](const Shape& s) { return lce_saliency(s.mesh.vertices, s.mesh.faces, {}); });
  add("VIS", source,
      [](const Shape& s) { return vis_saliency(s.mesh.vertices, s.normals, s.mesh.faces, {}); });
  add("NV", source, [](const Shape& s) { return nv_saliency(s.mesh.vertices, s.normals, {}); });
}

void add_mesh(const Source& source) {
  add("normals", source, [](const Shape& s) { return mesh_normals(s.mesh); });
  add("FPFH", source, [](const Shape& s) { return fpfh(s.mesh.vertices, s.normals, FpfhOptions{}); });
  add_models(source);
}

// All scans of the mesh, with their common scene.
std::size_t count_scanned(const Mesh& mesh) {
  const ScanScene scene(mesh);
  std::size_t points = 0;
  for (int view = 0; view < kViews; ++view) points += scene.scan(view).points.size();
  return points;
}

void add_scan(Source source) {
  add("scans", source, [](const Shape& s) { return count_scanned(s.mesh); });
  source.name += "_0";
  source.is_scan = true;
  add("normals", source, [](const Shape& s) { return scan_normals(*s.scan); });
  add("surface", source, [](const Shape& s) { return partial_mesh(s.mesh.vertices, s.normals); });
  add("FPFH", source, [](const Shape& s) { return fpfh(s.mesh.vertices, s.normals, ScanFpfhOptions{}); });
  add_models(source);
}

void register_spheres() {
  add_mesh({.name = "sphere"});
  add_mesh({.name = "sphere_with_stray", .stray = 1e4});
}

void register_real(const std::filesystem::path& data) {
  const MeshesBySize meshes = meshes_by_size(data);
  for (const std::size_t n : {2'000, 5'000, 10'000, 27'000}) {
    const Source source = mesh_of_size(meshes, n);
    add_mesh(source);
    add_scan(source);
  }
  Source source = mesh_of_size(meshes, 15'625);  // 4^3 of these are a million
  for (const unsigned int times : {1U, 2U, 3U}) {
    source.subdivisions = times;
    source.name = source.file.stem().string() + ":subdivided" + std::to_string(times);
    add_mesh(source);
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
