// SPDX-License-Identifier: GPL-3.0-or-later
// Files exchanged with commands of the user (salbench/models/command.py).
#include <string>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "io/hdf5/hdf5_file.h"
#include "io/shapes/shape_file.h"
#include "io/shapes/values_file.h"
#include "python/arrays.h"
#include "python/computing.h"
#include "python/module.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/descriptors/fpfh.h"

namespace salbench::python {
namespace {

// Parts of a shape, from Python arrays or None.
struct Parts {
  Parts(py::handle points_of, py::handle normals_of, py::handle faces_of)
      : points(vectors({points_of, "points"})),
        normals(vectors({normals_of, "normals"})),
        triangles(faces({faces_of, "faces"}, points.size())) {}
  View<Vec3> points, normals;
  Faces triangles;
};

Array rows_of(const char* name, std::span<const Vec3> rows, const char* description) {
  std::vector<double> values;
  values.reserve(3 * rows.size());
  for (const Vec3& row : rows) values.insert(values.end(), {row.x(), row.y(), row.z()});
  return {name, {rows.size(), 3}, std::move(values), "1", description};
}

py::bytes shape_ply(py::handle points, py::handle normals, py::handle faces) {
  const Parts parts(points, normals, faces);
  return computed(
      [&] { return ply_of({.points = parts.points, .normals = parts.normals, .faces = parts.triangles}); });
}

py::bytes shape_hdf5(py::handle points, py::handle normals, py::handle faces, py::handle fpfh) {
  const Parts parts(points, normals, faces);
  Hdf5Content content{{rows_of("points", parts.points, "coordinates, in the mesh's unit")}, {}};
  if (parts.normals.size() > 0) content.arrays.push_back(rows_of("normals", parts.normals, "unit normals"));
  if (!parts.triangles.empty()) {
    std::vector<std::int32_t> corners;
    for (const Triangle& face : parts.triangles) corners.insert(corners.end(), face.begin(), face.end());
    content.arrays.push_back(
        {"faces", {parts.triangles.size(), 3}, std::move(corners), "1", "0-based points of each triangle"});
  }
  if (!fpfh.is_none()) {
    const auto given = py::array_t<float, py::array::c_style>::ensure(fpfh);
    if (!given) throw py::error_already_set();
    std::vector<float> values(given.data(), given.data() + given.size());
    content.arrays.push_back(
        {"fpfh", {parts.points.size(), kFpfhBins}, std::move(values), "1", "descriptors"});
  }
  const Bytes image = computed([&] { return hdf5_image(content); });
  return {reinterpret_cast<const char*>(image.data()), image.size()};
}

// Throws InputError, one line that begins with `title`, unless there is one finite value per point, or per
// face if faces may have values too.
void check_values(py::handle values_of, const std::string& title, std::size_t n_points, std::size_t n_faces) {
  const auto values = map_values({values_of, "values"});
  require_value_per_element(title, values.size(), n_points, n_faces);
  if (const std::string wrong = wrong_with_values(values.values); !wrong.empty())
    throw InputError(fmt::format("{}: {}", title, wrong));
}

// Parses one number per line.
py::array values_in_text(const py::bytes& data, const std::string& title) {
  return moved(parse_values(std::string_view(data), title));
}

}  // namespace

void bind_commands(py::module_& module) {
  module.def("shape_ply", &shape_ply);
  module.def("shape_hdf5", &shape_hdf5);
  module.def("check_values", &check_values);
  module.def("parse_values", &values_in_text);
}

}  // namespace salbench::python
