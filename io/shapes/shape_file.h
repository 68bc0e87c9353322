// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes with values per point, as PLY files for other programs: MeshLab, CloudCompare, ParaView.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

struct PointField {
  std::string name;  // only letters, digits, '_' and '-'
  ScalarField values;
};

struct ShapeWithFields {
  std::span<const Vec3> points;
  std::span<const Vec3> normals = {};    // one per point, or empty
  std::span<const Triangle> faces = {};  // may be empty
  std::vector<PointField> fields = {};   // one value per point
  std::string remark = {};               // one line, as a comment in the file
};

// Bytes of a binary little-endian file: x, y, z as double, all other vertex properties as float [turk1994].
std::string ply_of(const ShapeWithFields& shape);

}  // namespace salbench
