// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/loaded.h"

#include <span>

#include <pybind11/stl.h>

#include "pipeline/inputs/loading.h"
#include "python/arrays.h"
#include "python/shape_rules.h"
#include "stages/geometry/smoothing.h"

namespace salbench::python {
namespace {

template <class T>
py::object shown_of(const std::shared_ptr<const ShapeInForm>& owner, const std::vector<T>& values) {
  return read_only(shown(owner, std::span<const T>(values)));
}

template <class T>
py::tuple all_shown(const std::shared_ptr<const ShapeInForm>& owner, const std::vector<std::vector<T>>& all) {
  py::tuple arrays(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) arrays[i] = shown_of(owner, all[i]);
  return arrays;
}

}  // namespace

Mesh surface_mesh(const ShapeInForm& shape) {
  if (!shape.is_cloud) return shape.mesh;
  ShapeRules rules({}, kClouds, held(shape.cloud));
  return mesh_of(shape.cloud, value_as<Faces>(*rules.value(Role::surface)));
}

ShapeInForm with_saliency(ShapeInForm usable) {
  for (TruthInForm& found : usable.truths)
    if (found.truth.saliency.empty())
      found.truth.saliency = smoothed_picks(surface_mesh(usable), found.truth.picks);
  return usable;
}

py::tuple arrays_of(const std::shared_ptr<const ShapeInForm>& shape) {
  const auto& [mesh, polygons, is_cloud, cloud, truths, recording, about, remark] = *shape;
  const py::object points = shown_of(shape, is_cloud ? cloud.points : mesh.vertices);
  const py::object faces = is_cloud ? py::none() : shown_of(shape, mesh.faces);
  const py::object normals = cloud.normals.empty() ? py::none() : shown_of(shape, cloud.normals);
  if (truths.empty()) return py::make_tuple(points, faces, normals, py::none(), py::tuple(), py::tuple());
  const GroundTruth& truth = truths[0].truth;
  return py::make_tuple(points, faces, normals, shown_of(shape, truth.saliency),
                        all_shown(shape, truth.picks), all_shown(shape, truth.viewers));
}

ItemChoice choice_of(py::handle items) {
  if (items.is_none()) return {};
  if (py::isinstance<py::bytes>(items)) return items.cast<std::string>();
  return ItemChoice(items.cast<std::vector<std::string>>());
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

py::list file_texts(const std::vector<std::string>& all) {
  py::list list;
  for (const std::string& text : all) list.append(file_text(text));
  return list;
}

}  // namespace salbench::python
