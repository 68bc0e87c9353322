// SPDX-License-Identifier: GPL-3.0-or-later
// Real shapes with what the stages read of them, shared by the programs that time stages on real data.
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
  // From add_scan() on:
  std::optional<Scan> scan;  // view 0
  Normals scan_normals;
  Descriptors scan_descriptors;
  Faces surface;  // of the scan

  explicit Shape(Mesh of);
  void add_scan();
};

struct Source {
  std::string name;                 // "20:15500": the file and its number of vertices
  std::filesystem::path file = {};  // none: a sphere of 10,242 vertices
  unsigned int subdivisions = 0;
  double stray = 0;  // distance of a corner of one more face, in radii of the sphere
};

using MeshesBySize = std::map<std::size_t, std::filesystem::path>;  // number of vertices -> file
MeshesBySize meshes_by_size(const std::filesystem::path& data);     // of a folder with SchellingData/

// The smallest mesh of at least so many vertices, or the largest of all.
Source mesh_of_size(const MeshesBySize& meshes, std::size_t vertices);

// Made when it is first asked for. Shapes of files are kept; of subdivided ones the last alone, since a
// million points are not kept beside others.
Shape& shape_of(const Source& source);

}  // namespace salbench
