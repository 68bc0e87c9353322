// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/faces.h"

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

Adjacency face_adjacency(std::size_t n_points, Surface faces) {
  const std::vector<EdgeSide> sides = edge_sides(n_points, faces);
  return adjacency_of(faces.size(), [&](auto&& visit) {
    for_each_edge(sides, [&](std::span<const EdgeSide> edge) {
      if (edge.size() != 2) return;
      visit(index(edge[0].face), edge[1].face);
      visit(index(edge[1].face), edge[0].face);
    });
  });
}

ScalarField values_by_face(FieldView map, std::size_t n_points, Surface faces) {
  if (map.size() != n_points && map.size() == faces.size()) return {map.begin(), map.end()};
  if (map.size() != n_points)
    throw ShapeError("the map has " + std::to_string(map.size()) + " values for " + std::to_string(n_points) +
                     " points and " + std::to_string(faces.size()) + " faces");
  const auto third = [&](std::int32_t i) {
    const double value = map[index(i)];
    return std::isnan(value) ? 0 : value / 3;  // as in matching and normalisation
  };
  ScalarField values;
  values.reserve(faces.size());
  for (const Triangle& face : faces) values.push_back(third(face[0]) + third(face[1]) + third(face[2]));
  return values;
}

}  // namespace salbench
