// SPDX-License-Identifier: GPL-3.0-or-later
// Faces with more than three corners, as mesh files have them, split into triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

// The triangles that a face with more than three corners was split into: those from the first on.
struct SplitPolygon {
  std::size_t first, triangles;
};

struct PolygonCounts {
  std::int64_t split = 0;                   // faces with more than three corners
  std::int64_t concave = 0;                 // those of them with a reflex corner
  std::vector<SplitPolygon> polygons = {};  // in the order of the file; empty where no file was parsed
};

// Number of faces in the file of a mesh that was parsed, and for each of its triangles the 0-based face that
// it is part of.
std::size_t faces_in_file(const PolygonCounts& counts, std::size_t n_triangles);
std::vector<std::int32_t> faces_of_triangles(const PolygonCounts& counts, std::size_t n_triangles);

// "16 faces, split into 32 triangles", "12 faces"
std::string text_of_faces(std::size_t n_in_file, std::size_t n_triangles);

// Takes the faces of a file in their order, before or after their vertices. n corners become n - 2 triangles
// over these corners, with the orientation of the polygon.
class Polygons {
 public:
  // Appends the face: a polygon as a fan around its first corner, to be looked at again by `split`. `place`
  // is where the face stands in the file.
  void add(std::span<const std::int32_t> corners, std::size_t place, std::vector<Triangle>& faces);

  // Called when all vertices are known. A fan stays where its triangles fill the polygon, as they do if it is
  // convex. Otherwise ears of the polygon, projected along its normal, take their place. Of a polygon without
  // area, such as one whose corners are collinear, all triangles are without area, and mesh_check drops them.
  // Calls `refuse`, which throws, for a polygon that crosses or overlaps itself.
  using Refuse = std::function<void(std::size_t place, const std::string& why)>;
  PolygonCounts split(Mesh& mesh, const Refuse& refuse) const;

 private:
  struct Fan {
    std::size_t first;  // of its triangles
    std::size_t corners;
    std::size_t place;
  };
  std::vector<Fan> fans_;
};

}  // namespace salbench
