// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/perf/shapes.h"

#include <fstream>
#include <iterator>
#include <tuple>
#include <utility>

#include "io/shapes/mesh_file.h"
#include "stages/descriptors/fpfh.h"
#include "stages/normals/normals.h"
#include "stages/scan/scan.h"
#include "stages/surface/surface.h"
#include "tests/support/shapes.h"
#include "tests/support/subdivided.h"

namespace salbench {
namespace {

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

}  // namespace

Shape::Shape(Mesh of) : mesh(std::move(of)), normals(mesh_normals(mesh)) {
  descriptors = fpfh(mesh.vertices, normals, FpfhOptions{});
}

void Shape::add_scan() {
  if (scan) return;
  scan = simulate_scan(mesh, 0);
  scan_normals = salbench::scan_normals(*scan);
  scan_descriptors = fpfh(scan->points, scan_normals, ScanFpfhOptions{});
  surface = partial_mesh(scan->points, scan_normals);
}

MeshesBySize meshes_by_size(const std::filesystem::path& data) {
  MeshesBySize meshes;
  for (const auto& entry : std::filesystem::directory_iterator(data / "SchellingData" / "Meshes"))
    meshes.emplace(vertices_of(entry.path()), entry.path());
  return meshes;
}

Source mesh_of_size(const MeshesBySize& meshes, std::size_t vertices) {
  const auto at = meshes.lower_bound(vertices);
  const auto& [size, file] = at == meshes.end() ? *std::prev(at) : *at;
  return {file.stem().string() + ":" + std::to_string(size), file};
}

Shape& shape_of(const Source& source) {
  using Key = std::tuple<std::filesystem::path, unsigned int, double>;
  static std::map<Key, Shape> made;
  const Key key(source.file, source.subdivisions, source.stray);
  if (const auto found = made.find(key); found != made.end()) return found->second;
  if (source.subdivisions > 0)
    std::erase_if(made, [](const auto& entry) { return std::get<1>(entry.first) > 0; });
  return made.emplace(key, Shape(mesh_of(source))).first->second;
}

}  // namespace salbench
