// SPDX-License-Identifier: GPL-3.0-or-later
// First hits of the rays of a picture, found by going over the faces and not over the rays.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

using Vec3f = Eigen::Vector3f;

// The image plane in eye space (stages/picture/camera.h), cut into side x side cells.
struct ImagePlane {
  int side = 0;
  double tan_half_field = 1;

  // Columns and rows are counted from the top left corner; the centre of the first cell is at 0.5, 0.5.
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

// Row by row, what the rays through the centres of an image plane's cells meet.
struct Seen {
  explicit Seen(const ImagePlane& plane);

  std::vector<std::int32_t> primitive;  // cell: face; -1: nothing
  std::vector<float> depth;             // cell: along z; infinity: nothing
};

// Points are in eye space, in front of the camera. A ray through an edge or a corner meets one of the faces
// there; of faces at one depth the first is seen.
Seen see_faces(std::span<const Vec3> points, std::span<const Triangle> faces, const ImagePlane& plane);

// Weights of the corners where a ray from the camera meets the plane of a face; sum 1, none below 0: what
// rounding puts outside the face is put on its edge.
Vec3 weights_at(std::span<const Vec3> points, const Triangle& face, const Vec3& ray);

}  // namespace salbench
