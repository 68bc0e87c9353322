// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/shape_file.h"

#include <bit>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>

#include "stages/core/check.h"

namespace salbench {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

template <class Number>
void append(std::string& bytes, Number number) {
  char raw[sizeof number];
  std::memcpy(raw, &number, sizeof number);
  bytes.append(raw, sizeof number);
}

std::string ply_header(const ShapeWithFields& shape) {
  std::string header = "ply\nformat binary_little_endian 1.0\n";
  if (!shape.remark.empty()) header += fmt::format("comment {}\n", shape.remark);
  header += fmt::format("element vertex {}\n", shape.points.size());
  for (const char* name : {"x", "y", "z"}) header += fmt::format("property double {}\n", name);
  if (!shape.normals.empty())
    for (const char* name : {"nx", "ny", "nz"}) header += fmt::format("property float {}\n", name);
  for (const PointField& field : shape.fields) header += fmt::format("property float {}\n", field.name);
  if (!shape.faces.empty())
    header += fmt::format("element face {}\nproperty list uchar int vertex_indices\n", shape.faces.size());
  return header + "end_header\n";
}

}  // namespace

std::string ply_of(const ShapeWithFields& shape) {
  if (!shape.normals.empty()) CHECK_EQ(shape.normals.size(), shape.points.size());
  for (const PointField& field : shape.fields) CHECK_EQ(field.values.size(), shape.points.size());
  std::string bytes = ply_header(shape);
  for (std::size_t i = 0; i < shape.points.size(); ++i) {
    for (const double x : shape.points[i]) append(bytes, x);
    if (!shape.normals.empty())
      for (const double n : shape.normals[i]) append(bytes, static_cast<float>(n));
    for (const PointField& field : shape.fields) append(bytes, static_cast<float>(field.values[i]));
  }
  for (const Triangle& face : shape.faces) {
    append(bytes, std::uint8_t{3});
    for (const std::int32_t vertex : face) append(bytes, vertex);
  }
  return bytes;
}

}  // namespace salbench
