// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/loaded.h"

#include <span>
#include <vector>

#include "pipeline/rules/config.h"
#include "python/arrays.h"
#include "stages/normals/normals.h"
#include "stages/surface/surface.h"

namespace salbench::python {
namespace {

template <class T>
py::object shown_of(const std::shared_ptr<const Loaded>& owner, const std::vector<T>& values) {
  return read_only(shown(owner, std::span<const T>(values)));
}

template <class T>
py::tuple all_shown(const std::shared_ptr<const Loaded>& owner, const std::vector<std::vector<T>>& all) {
  py::tuple arrays(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) arrays[i] = shown_of(owner, all[i]);
  return arrays;
}

}  // namespace

py::tuple arrays_of(const std::shared_ptr<const Loaded>& loaded) {
  py::object points, faces = py::none(), normals = py::none();
  if (const auto* mesh = std::get_if<Mesh>(&loaded->shape)) {
    points = shown_of(loaded, mesh->vertices);
    faces = shown_of(loaded, mesh->faces);
  } else {
    const auto& cloud = std::get<PointCloud>(loaded->shape);
    points = shown_of(loaded, cloud.points);
    if (!cloud.normals.empty()) normals = shown_of(loaded, cloud.normals);
  }
  if (!loaded->truth) return py::make_tuple(points, faces, normals, py::none(), py::tuple(), py::tuple());
  return py::make_tuple(points, faces, normals, shown_of(loaded, loaded->truth->saliency),
                        all_shown(loaded, loaded->truth->picks), all_shown(loaded, loaded->truth->viewers));
}

Faces surface_of(const PointCloud& cloud) {
  const Config defaults = read_config(Section::from_text("{}", "defaults"), "python");
  return partial_mesh(cloud.points, cloud_normals(cloud, defaults.scan_normals), defaults.surface);
}

py::str file_text(const std::string& bytes) {
  PyObject* text = PyUnicode_DecodeFSDefaultAndSize(bytes.data(), static_cast<py::ssize_t>(bytes.size()));
  if (text == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(text);
}

std::string file_bytes(py::handle text) {
  if (py::isinstance<py::bytes>(text)) return text.cast<std::string>();
  PyObject* bytes = PyUnicode_EncodeFSDefault(text.ptr());
  if (bytes == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::bytes>(bytes).cast<std::string>();
}

}  // namespace salbench::python
