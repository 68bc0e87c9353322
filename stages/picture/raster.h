// SPDX-License-Identifier: GPL-3.0-or-later
// First hits of a picture's rays, found by iterating over the faces instead of the rays.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

using Vec3f = Eigen::Vector3f;

// Image plane in eye space (stages/picture/camera.h), divided into side x side cells.
struct ImagePlane {
  int side = 0;
  double tan_half_field = 1;

  // Columns and rows start at the top left corner; the centre of the first cell is at 0.5, 0.5.
  double column(const Vec3& eye) const { return (eye.x() / (eye.z() * tan_half_field) + 1) / 2 * side; }
  double row(const Vec3& eye) const { return (1 - eye.y() / (eye.z() * tan_half_field)) / 2 * side; }
  Vec3 ray(double at_column, double at_row) const {  // z is 1
    return {(2 * at_column / side - 1) * tan_half_field, (1 - 2 * at_row / side) * tan_half_field, 1};
  }
  Vec3 ray_of_cell(int cell) const {
    const int column = cell % side, row = cell / side;
    return ray(column + 0.5, row + 0.5);
  }
  std::size_t cells() const { return static_cast<std::size_t>(side) * static_cast<std::size_t>(side); }
};

// Row by row, the first hits of the rays through the centres of an image plane's cells.
struct Seen {
  explicit Seen(const ImagePlane& plane);

  std::vector<std::int32_t> primitive;  // cell: face; -1: nothing
  std::vector<float> depth;             // cell: along z; infinity: nothing
};

// Points are in eye space, in front of the camera. A ray through an edge or a corner meets one of the faces
// there; among faces of equal depth, the first is visible.
Seen see_faces(std::span<const Vec3> points, std::span<const Triangle> faces, const ImagePlane& plane);

// Weights of the corners at the intersection of a ray from the camera with a face's plane; sum 1,
// non-negative: points outside the face by rounding are moved to its edge.
Vec3 weights_at(std::span<const Vec3> points, const Triangle& face, const Vec3& ray);

}  // namespace salbench
