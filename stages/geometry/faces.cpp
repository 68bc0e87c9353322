// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/faces.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "stages/core/errors.h"

namespace salbench {

std::vector<Vec3> face_centroids(Points points, Surface faces) {
  std::vector<Vec3> centroids;
  centroids.reserve(faces.size());
  for (const Triangle& face : faces)
    centroids.emplace_back((at(points, face[0]) + at(points, face[1]) + at(points, face[2])) / 3);
  return centroids;
}

ScalarField face_areas(Points points, Surface faces) {
  ScalarField areas;
  areas.reserve(faces.size());
  for (const Triangle& face : faces) areas.push_back(face_area_vector(points, face).norm() / 2);
  return areas;
}

Adjacency face_adjacency(Surface faces) {
  struct Side {
    std::int32_t low, high, face;
    auto operator<=>(const Side&) const = default;
  };
  std::vector<Side> sides;
  sides.reserve(3 * faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(faces[i][k], faces[i][(k + 1) % 3]);
      sides.push_back({low, high, static_cast<std::int32_t>(i)});
    }
  std::ranges::sort(sides);
  return adjacency_of(faces.size(), [&](auto&& visit) {
    for (auto first = sides.begin(); first != sides.end();) {
      const auto last = std::find_if(first, sides.end(), [&](const Side& side) {
        return side.low != first->low || side.high != first->high;
      });
      if (last - first == 2) {
        visit(index(first[0].face), first[1].face);
        visit(index(first[1].face), first[0].face);
      }
      first = last;
    }
  });
}

ScalarField values_by_face(FieldView map, std::size_t n_points, Surface faces) {
  if (map.size() != n_points && map.size() == faces.size()) return {map.begin(), map.end()};
  if (map.size() != n_points)
    throw ShapeError("the map has " + std::to_string(map.size()) + " values for " + std::to_string(n_points) +
                     " points and " + std::to_string(faces.size()) + " faces");
  const auto third = [&](std::int32_t i) {
    const double value = map[index(i)];
    return std::isnan(value) ? 0 : value / 3;  // as matching and normalisation have it
  };
  ScalarField values;
  values.reserve(faces.size());
  for (const Triangle& face : faces) values.push_back(third(face[0]) + third(face[1]) + third(face[2]));
  return values;
}

}  // namespace salbench
