// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/shape_file.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <numeric>

#include <fmt/format.h>

#include "io/table.h"
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

// --- CSV ------------------------------------------------------------------------------------------------

std::string csv_of(const ShapeWithFields& shape) {
  Table table{.columns = {"x", "y", "z"}, .rows = {}};
  if (!shape.remark.empty()) table.remarks = {shape.remark};
  if (!shape.normals.empty()) table.columns.insert(table.columns.end(), {"nx", "ny", "nz"});
  for (const PointField& field : shape.fields) table.columns.push_back(field.name);
  for (std::size_t i = 0; i < shape.points.size(); ++i) {
    const auto& p = shape.points[i];
    std::vector<Cell> row = {p.x(), p.y(), p.z()};
    if (!shape.normals.empty())
      row.insert(row.end(), {shape.normals[i].x(), shape.normals[i].y(), shape.normals[i].z()});
    for (const PointField& field : shape.fields) row.emplace_back(field.values[i]);
    table.rows.push_back(std::move(row));
  }
  return to_csv(table);
}

// --- PLY ------------------------------------------------------------------------------------------------

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

std::string ply_of(const ShapeWithFields& shape) {
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

// --- VTP: an uncompressed block is the number of its bytes (UInt64) and the bytes, in one run of base64 ----

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto byte_at = [&](std::size_t i) {
    return i < bytes.size() ? static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i])) : 0U;
  };
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::uint32_t triple = byte_at(i) << 16U | byte_at(i + 1) << 8U | byte_at(i + 2);
    for (const std::uint32_t shift : {18U, 12U, 6U, 0U}) text += kDigits[triple >> shift & 63U];
    if (i + 2 >= bytes.size()) text.back() = '=';
    if (i + 1 >= bytes.size()) text[text.size() - 2] = '=';
  }
  return text;
}

constexpr const char* vtk_type(double) { return "Float64"; }
constexpr const char* vtk_type(std::int64_t) { return "Int64"; }

template <class Number>
std::string data_array(std::string_view name, int components, const std::vector<Number>& values) {
  const std::size_t size = values.size() * sizeof(Number);
  std::string block;
  append(block, static_cast<std::uint64_t>(size));
  block.append(reinterpret_cast<const char*>(values.data()), size);
  return fmt::format(
      "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"binary\">{}</DataArray>\n",
      vtk_type(Number{}), name, components, base64(block));
}

std::vector<double> flattened(std::span<const Vec3> rows) {
  std::vector<double> flat;
  flat.reserve(3 * rows.size());
  for (const Vec3& row : rows) flat.insert(flat.end(), {row.x(), row.y(), row.z()});
  return flat;
}

// Cells of `size` points each: the indices of their points, and where each cell ends.
std::string cells(std::string_view element, const std::vector<std::int64_t>& connectivity, std::size_t size) {
  std::vector<std::int64_t> offsets(connectivity.size() / size);
  for (std::size_t i = 0; i < offsets.size(); ++i) offsets[i] = static_cast<std::int64_t>((i + 1) * size);
  return fmt::format("<{0}>\n{1}{2}</{0}>\n", element, data_array("connectivity", 1, connectivity),
                     data_array("offsets", 1, offsets));
}

std::string vtp_of(const ShapeWithFields& shape) {
  std::vector<std::int64_t> vertices(shape.faces.empty() ? shape.points.size() : 0);
  std::iota(vertices.begin(), vertices.end(), 0);
  std::vector<std::int64_t> corners;
  for (const Triangle& face : shape.faces) corners.insert(corners.end(), face.begin(), face.end());

  std::string xml = "<?xml version=\"1.0\"?>\n";
  if (!shape.remark.empty()) xml += fmt::format("<!-- {} -->\n", shape.remark);
  xml += fmt::format(
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "<PolyData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" "
      "NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n",
      shape.points.size(), vertices.size(), shape.faces.size());
  xml += shape.normals.empty() ? "<PointData>\n" : "<PointData Normals=\"normals\">\n";
  if (!shape.normals.empty()) xml += data_array("normals", 3, flattened(shape.normals));
  for (const PointField& field : shape.fields) xml += data_array(field.name, 1, field.values);
  xml += "</PointData>\n<Points>\n" + data_array("points", 3, flattened(shape.points)) + "</Points>\n";
  xml += cells("Verts", vertices, 1) + cells("Polys", corners, 3);
  return xml + "</Piece>\n</PolyData>\n</VTKFile>\n";
}

}  // namespace

std::string shape_text(const ShapeWithFields& shape, ShapeFormat format) {
  if (!shape.normals.empty()) CHECK_EQ(shape.normals.size(), shape.points.size());
  for (const PointField& field : shape.fields) CHECK_EQ(field.values.size(), shape.points.size());
  switch (format) {
    case ShapeFormat::csv:
      return csv_of(shape);
    case ShapeFormat::ply:
      return ply_of(shape);
    default:
      return vtp_of(shape);
  }
}

}  // namespace salbench
