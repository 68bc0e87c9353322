// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/mesh_parts.h"

#include <fmt/format.h>

#include "stages/core/field.h"

namespace salbench {

std::string_view wrong_with_point(const Vec3& point) {
  if (!point.allFinite()) return "a coordinate is not a finite number";
  if (point.cwiseAbs().maxCoeff() > kLargestCoordinate)
    return "a coordinate is larger than 1e50: scale the mesh";
  return {};
}

std::string wrong_with_count(std::int64_t count, std::string_view plural) {
  if (count < 0) return fmt::format("{} {}: a count cannot be negative", count, plural);
  if (count > kMaxVertices) return fmt::format("{} {}: at most {} can be read", count, plural, kMaxVertices);
  return {};
}

std::string wrong_with_polygon(double n_vertices) {
  if (n_vertices >= 3) return {};
  return fmt::format("a face with {} vertices: it needs at least 3", n_vertices);
}

std::string index_out_of_range(double index, std::int64_t first, std::int64_t n_vertices) {
  return fmt::format("vertex index {} is out of range: there are {} vertices, numbered from {}", index,
                     n_vertices, first);
}

}  // namespace salbench
