// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces of known curvature, and one with a bump.
#pragma once

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "tests/support/shapes.h"

namespace salbench::shapes {

// A grid of columns x rows vertices, closed along the columns, and along the rows if `closed`; normals point
// outwards if u x v does.
template <class Place>
Mesh wrapped(int columns, int rows, bool closed, const Place& place) {
  Mesh mesh;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      mesh.vertices.push_back(place(2 * std::numbers::pi * column / columns, row));
  const auto at = [&](int column, int row) { return (row % rows) * columns + column % columns; };
  for (int row = 0; row + (closed ? 0 : 1) < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      mesh.faces.push_back({at(column, row), at(column + 1, row), at(column + 1, row + 1)});
      mesh.faces.push_back({at(column, row), at(column + 1, row + 1), at(column, row + 1)});
    }
  return mesh;
}

// Open, around the z axis.
inline Mesh cylinder(double radius, double height, int columns, int rows) {
  return wrapped(columns, rows, false, [=](double u, int row) {
    return Vec3(radius * std::cos(u), radius * std::sin(u), height * row / (rows - 1));
  });
}

// Around the z axis. At the angle v of the tube the mean curvature is (R + 2 r cos v) / (2 r (R + r cos v)).
inline Mesh torus(double radius, double tube, int columns, int rows) {
  return wrapped(columns, rows, true, [=](double u, int row) {
    const double v = 2 * std::numbers::pi * row / rows, from_axis = radius + tube * std::cos(v);
    return Vec3(from_axis * std::cos(u), from_axis * std::sin(u), tube * std::sin(v));
  });
}

// The unit sphere with one bump, at +z.
inline Mesh sphere_with_bump(int levels, double height = 0.15, double width = 0.15) {
  Mesh mesh = sphere(levels);
  for (Vec3& v : mesh.vertices)
    v *= 1 + height * std::exp(-(v - Vec3::UnitZ()).squaredNorm() / (2 * width * width));
  return mesh;
}

inline Mesh moved(Mesh mesh, double scale) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.7, Vec3(1, 2, -0.5).normalized()));
  for (Vec3& v : mesh.vertices) v = scale * (turn * v + Vec3(3, -5, 7));
  return mesh;
}

}  // namespace salbench::shapes
