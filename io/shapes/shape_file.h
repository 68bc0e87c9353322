// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes with values at their points, as PLY files for other programs: MeshLab, CloudCompare, ParaView.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

struct PointField {
  std::string name;  // of letters, digits, '_' and '-'
  ScalarField values;
};

struct ShapeWithFields {
  std::span<const Vec3> points;
  std::span<const Vec3> normals = {};    // one per point, or none
  std::span<const Triangle> faces = {};  // may be none
  std::vector<PointField> fields = {};   // one value per point
  std::string remark = {};               // one line for readers of the file's text
};

// The bytes of a file, binary little endian: x, y, z as double, everything else at a vertex as float
// [turk1994].
std::string ply_of(const ShapeWithFields& shape);

}  // namespace salbench
