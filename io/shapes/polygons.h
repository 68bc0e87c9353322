// SPDX-License-Identifier: GPL-3.0-or-later
// Splits faces with more than three corners, as found in mesh files, into triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

// Triangles of a face with more than three corners: index of the first, and number.
struct SplitPolygon {
  std::size_t first, triangles;
};

struct PolygonCounts {
  std::int64_t split = 0;                   // faces with more than three corners
  std::int64_t concave = 0;                 // faces with a reflex corner among them
  std::vector<SplitPolygon> polygons = {};  // in the file's order; empty if no file was parsed
};

// Number of faces in the file of a parsed mesh; and for each of its triangles, the 0-based face of which it
// is a part.
std::size_t faces_in_file(const PolygonCounts& counts, std::size_t n_triangles);
std::vector<std::int32_t> faces_of_triangles(const PolygonCounts& counts, std::size_t n_triangles);

// "16 faces, split into 32 triangles", "12 faces"
std::string text_of_faces(std::size_t n_in_file, std::size_t n_triangles);

// Collects the faces of a file in order, before or after their vertices. n corners become n - 2 triangles
// over the same corners, with the polygon's orientation.
class Polygons {
 public:
  // Appends a face: a polygon as a fan around its first corner, checked later by `split`. `place`: position
  // of the face in the file.
  void add(std::span<const std::int32_t> corners, std::size_t place, std::vector<Triangle>& faces);

  // Called once all vertices are known. Keeps a fan whose triangles fill the polygon, as for convex ones;
  // otherwise replaces it by ear clipping of the polygon projected along its normal. A polygon without area,
  // such as one with collinear corners, gives triangles without area, which mesh_check drops. Calls `refuse`,
  // which throws, for a polygon that intersects or overlaps itself.
  using Refuse = std::function<void(std::size_t place, const std::string& why)>;
  PolygonCounts split(Mesh& mesh, const Refuse& refuse) const;

 private:
  struct Fan {
    std::size_t first;  // index of its first triangle
    std::size_t corners;
    std::size_t place;
  };
  std::vector<Fan> fans_;
};

}  // namespace salbench
