// SPDX-License-Identifier: GPL-3.0-or-later
// Point clouds as files for tests, with numbers that read back to the same bits.
#pragma once

#include <span>
#include <string>

#include <fmt/format.h>

#include "stages/core/types.h"

namespace salbench {

inline std::string xyz_text(std::span<const Vec3> points, std::span<const Vec3> normals = {}) {
  std::string text;
  for (std::size_t i = 0; i < points.size(); ++i) {
    text += fmt::format("{} {} {}", points[i].x(), points[i].y(), points[i].z());
    if (!normals.empty()) text += fmt::format(" {} {} {}", normals[i].x(), normals[i].y(), normals[i].z());
    text += '\n';
  }
  return text;
}

inline std::string ply_cloud_text(std::span<const Vec3> points, std::span<const Vec3> normals = {}) {
  std::string text = fmt::format("ply\nformat ascii 1.0\nelement vertex {}\n", points.size());
  for (const char* axis : {"x", "y", "z"}) text += fmt::format("property double {}\n", axis);
  if (!normals.empty())
    for (const char* axis : {"nx", "ny", "nz"}) text += fmt::format("property double {}\n", axis);
  return text + "end_header\n" + xyz_text(points, normals);
}

}  // namespace salbench
