// SPDX-License-Identifier: GPL-3.0-or-later
// Real shapes with the inputs of the stages, shared by programs that time stages on real data.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "stages/core/types.h"

namespace salbench {

struct Shape {
  Mesh mesh;
  Normals normals;
  Descriptors descriptors;
  // Set by add_scan():
  std::optional<Scan> scan;  // view 0
  Normals scan_normals;
  Descriptors scan_descriptors;
  Faces surface;  // partial mesh of the scan

  explicit Shape(Mesh of);
  void add_scan();
};

struct Source {
  std::string name;                 // "20:15500": the file and its number of vertices
  std::filesystem::path file = {};  // empty: a sphere of 10,242 vertices
  unsigned int subdivisions = 0;
  double stray = 0;  // distance of a stray corner, in radii of the sphere
};

using MeshesBySize = std::map<std::size_t, std::filesystem::path>;  // number of vertices -> file
MeshesBySize meshes_by_size(const std::filesystem::path& data);     // `data` contains SchellingData/

// Smallest mesh with at least `vertices`, or the largest of all.
Source mesh_of_size(const MeshesBySize& meshes, std::size_t vertices);

// Loaded on first use. Shapes from files are kept; of subdivided shapes only the last, because of their size.
Shape& shape_of(const Source& source);

}  // namespace salbench
