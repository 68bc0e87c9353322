// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes with values at their points, as files for other programs: MeshLab, CloudCompare, ParaView.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stages/core/options.h"
#include "stages/core/types.h"

namespace salbench {

// csv  one row per point: x, y, z, nx, ny, nz, then the fields; no faces; doubles read back as the same
// ply  binary little endian; x, y, z as double, everything else at a vertex as float [turk1994]
// vtp  VTK's PolyData in XML, base64, double precision; points without faces become vertex cells
enum class ShapeFormat { csv, ply, vtp };
template <>
struct EnumNames<ShapeFormat> {
  static constexpr std::array<std::string_view, 3> names{"csv", "ply", "vtp"};
};

struct PointField {
  std::string name;  // of letters, digits, '_' and '-'
  ScalarField values;
};

struct ShapeWithFields {
  std::span<const Vec3> points;
  std::span<const Vec3> normals = {};    // one per point, or none
  std::span<const Triangle> faces = {};  // may be none
  std::vector<PointField> fields = {};   // one value per point
  std::string remark = {};               // one line for readers of the file's text; without "--"
};

// The bytes of the file.
std::string shape_text(const ShapeWithFields& shape, ShapeFormat format);

}  // namespace salbench
