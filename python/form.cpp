// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/form.h"

#include <cstdint>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "python/arrays.h"
#include "python/computing.h"
#include "python/loaded.h"
#include "python/module.h"
#include "stages/core/errors.h"

namespace salbench::python {
namespace {

// --- from Python ------------------------------------------------------------------------------------------

ScalarField field_of(py::handle values, const char* name, std::optional<std::size_t> n = {}) {
  if (values.is_none()) return {};
  const auto view = field({values, name}, n);
  return {view.values.begin(), view.values.end()};
}

// Ground truth of a Shape with n points and n_faces faces; none where none is known.
std::optional<TruthInForm> truth_from(py::handle shape, const std::string& view, std::size_t n,
                                      std::size_t n_faces) {
  TruthInForm truth{.view = view};
  truth.truth.saliency = field_of(shape.attr("truth"), "truth", n);
  if (const py::object all = shape.attr("viewers"); !all.is_none()) {
    const auto maps = rows({all, "viewers"}, {});
    if (n == 0 || maps.size() % n != 0) throw py::value_error("viewers must have shape (v, n)");
    for (auto row = maps.values.begin(); row != maps.values.end(); row += static_cast<std::ptrdiff_t>(n))
      truth.truth.viewers.emplace_back(row, row + static_cast<std::ptrdiff_t>(n));
  }
  bool any_pick = false;
  for (const py::handle one : shape.attr("picks")) {
    truth.truth.picks.push_back(indices({one, "picks"}, n));
    any_pick |= !truth.truth.picks.back().empty();
  }
  truth.face_values = field_of(shape.attr("face_truth"), "face_truth", n_faces);
  if (truth.truth.saliency.empty() && truth.truth.viewers.empty() && !any_pick) return {};
  return truth;
}

GazeRecording recording_from(py::handle given) {
  GazeRecording recording;
  for (const py::handle name : given.attr("people")) recording.people.push_back(file_bytes(name));
  recording.person = indices({given.attr("person"), "person"}, recording.people.size());
  const std::size_t m = recording.person.size();
  recording.time = field_of(given.attr("time"), "time", m);
  const auto valid =
      py::array_t<bool, py::array::c_style | py::array::forcecast>::ensure(given.attr("valid"));
  if (!valid || static_cast<std::size_t>(valid.size()) != m)
    throw py::value_error(fmt::format("valid must have {} values", m));
  recording.valid.assign(valid.data(), valid.data() + m);
  const auto triples_at = [&](const char* name) {
    const py::object column = given.attr(name);
    if (column.is_none()) return std::vector<Vec3>();
    std::vector<Vec3> all = triples_of(column, name);
    if (all.size() != m) throw py::value_error(fmt::format("{} must have shape ({}, 3)", name, m));
    return all;
  };
  recording.origins = triples_at("origins");
  recording.directions = triples_at("directions");
  recording.points = triples_at("points");
  recording.durations = field_of(given.attr("durations"), "durations", m);
  return recording;
}

void fill_cloud(py::handle shape, PointCloud& cloud) {
  const std::size_t n = cloud.points.size();
  if (const py::object normal_of = shape.attr("normals"); !normal_of.is_none()) {
    const auto unit = normals({normal_of, "normals"}, n);
    cloud.normals.assign(unit.values.begin(), unit.values.end());
  }
  if (const py::object from = shape.attr("viewpoint"); !from.is_none())
    cloud.viewpoint = place({from, "viewpoint"});
  if (const py::object out = shape.attr("left_out"); !out.is_none())
    cloud.dropped = indices({out, "left_out"}, n + static_cast<std::size_t>(py::len(out)));
}

// --- to Python --------------------------------------------------------------------------------------------

py::object or_none(bool given, const auto& array) { return given ? py::object(array()) : py::none(); }

py::dict dict_of(TruthInForm truth, std::size_t n) {
  py::list picked;
  for (std::vector<std::int32_t>& own : truth.truth.picks) picked.append(moved(std::move(own)));
  py::dict fields;
  fields["truth"] =
      or_none(!truth.truth.saliency.empty(), [&] { return moved(std::move(truth.truth.saliency)); });
  fields["viewers"] = or_none(!truth.truth.viewers.empty(), [&] {
    std::vector<double> all;
    for (const ScalarField& map : truth.truth.viewers) all.insert(all.end(), map.begin(), map.end());
    return moved(std::move(all), {-1, static_cast<py::ssize_t>(n)});
  });
  fields["picks"] = py::tuple(picked);
  fields["face_truth"] =
      or_none(!truth.face_values.empty(), [&] { return moved(std::move(truth.face_values)); });
  return fields;
}

py::dict dict_of(GazeRecording recording) {
  py::dict fields;
  py::list people;
  for (const std::string& name : recording.people) people.append(file_text(name));
  fields["people"] = py::tuple(people);
  fields["person"] = moved(std::move(recording.person));
  fields["time"] = moved(std::move(recording.time));
  fields["valid"] = moved(std::vector<std::uint8_t>(recording.valid)).attr("astype")(py::dtype::of<bool>());
  const auto given = [&](const char* name, auto& column) {
    fields[name] = or_none(!column.empty(), [&] { return moved(std::move(column)); });
  };
  given("origins", recording.origins);
  given("directions", recording.directions);
  given("points", recording.points);
  given("durations", recording.durations);
  return fields;
}

// --- the HDF5 form ----------------------------------------------------------------------------------------

// The bytes of a file. shape: points, faces and recording; truths: shapes by view; about: texts by name.
py::bytes image_of(py::handle given, const py::dict& truths, const py::dict& about) {
  ShapeInForm shape = shape_from(given, "");
  shape.truths.clear();
  const std::size_t n = shape.is_cloud ? shape.cloud.points.size() : shape.mesh.vertices.size();
  for (const auto& [view, of_view] : truths)
    if (auto truth = truth_from(of_view, file_bytes(view), n, shape.mesh.faces.size()))
      shape.truths.push_back(std::move(*truth));
  for (const auto& [key, text] : about) shape.about.emplace_back(file_bytes(key), file_bytes(text));
  const Bytes image = computed([&] { return one_form_image(shape); });
  return {reinterpret_cast<const char*>(image.data()), image.size()};
}

// None if no program of ours wrote the bytes.
py::object fields_of_bytes(const py::bytes& data, const std::string& name) {
  const std::string_view bytes = data;
  auto shape = computed([&] { return shape_in_form(bytes, name); });
  return shape ? py::object(fields_of(std::move(*shape))) : py::none();
}

template <class T>
Array array_from(const std::string& name, const py::array& given) {
  const auto values = py::array_t<T, py::array::c_style | py::array::forcecast>::ensure(given);
  return {.name = name,
          .shape = {given.shape(), given.shape() + given.ndim()},
          .values = std::vector<T>(values.data(), values.data() + values.size()),
          .unit = "",
          .description = ""};
}

// Data sets by their names in the form, as somebody else's file has them, checked.
py::dict fields_of_arrays(const py::dict& given, const std::string& name) {
  Arrays arrays;
  for (const auto& [key, value] : given) {
    const auto array = py::reinterpret_borrow<py::array>(value);
    const std::string data_set = file_bytes(key);
    const auto size = array.itemsize();
    const char kind = array.dtype().kind();
    if (kind == 'b' || (kind == 'u' && size == 1))
      arrays.push_back(array_from<std::uint8_t>(data_set, array));
    else if (kind == 'f')
      arrays.push_back(size == 8 ? array_from<double>(data_set, array) : array_from<float>(data_set, array));
    else
      arrays.push_back(size > 4 ? array_from<std::int64_t>(data_set, array)
                                : array_from<std::int32_t>(data_set, array));
  }
  return fields_of(computed([&] { return shape_in_arrays(arrays, name); }));
}

}  // namespace

std::vector<Vec3> triples_of(py::handle array, const char* name) {
  const auto given = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!given || given.ndim() != 2 || given.shape(1) != 3)
    throw py::value_error(fmt::format("{} must have shape (n, 3)", name));
  const auto* first = reinterpret_cast<const Vec3*>(given.data());
  return {first, first + given.shape(0)};
}

ShapeInForm shape_from(py::handle given, const std::string& view) {
  const auto where = points(required(given.attr("points"), "points"));
  std::vector<Vec3> place_of(where.values.begin(), where.values.end());
  ShapeInForm shape{.is_cloud = given.attr("faces").is_none()};
  std::tie(shape.polygons.split, shape.polygons.concave) =
      given.attr("polygons").cast<std::pair<std::int64_t, std::int64_t>>();
  if (shape.is_cloud) {
    shape.cloud.points = std::move(place_of);
    fill_cloud(given, shape.cloud);
  } else {
    shape.mesh = {std::move(place_of), faces({given.attr("faces"), "faces"}, where.size())};
  }
  if (auto truth = truth_from(given, view, where.size(), shape.mesh.faces.size()))
    shape.truths.push_back(std::move(*truth));
  if (const py::object recording = given.attr("recording"); !recording.is_none())
    shape.recording = recording_from(recording);
  return shape;
}

py::dict fields_of(ShapeInForm shape) {
  py::dict fields;
  auto& [place_of, normal_of, viewpoint, dropped] = shape.cloud;
  const std::size_t n = shape.is_cloud ? place_of.size() : shape.mesh.vertices.size();
  py::dict truths;
  for (TruthInForm& truth : shape.truths) {
    const py::str view = file_text(truth.view);
    truths[view] = dict_of(std::move(truth), n);
  }
  fields["points"] = moved(std::move(shape.is_cloud ? place_of : shape.mesh.vertices));
  fields["faces"] = or_none(!shape.is_cloud, [&] { return moved(std::move(shape.mesh.faces)); });
  fields["normals"] = or_none(!normal_of.empty(), [&] { return moved(std::move(normal_of)); });
  fields["viewpoint"] = or_none(viewpoint.has_value(), [&] {
    return moved(std::vector<double>(viewpoint->begin(), viewpoint->end()));
  });
  fields["left_out"] = or_none(!dropped.empty(), [&] { return moved(std::move(dropped)); });
  fields["polygons"] = py::make_tuple(shape.polygons.split, shape.polygons.concave);
  fields["truths"] = truths;
  fields["recording"] =
      or_none(!shape.recording.empty(), [&] { return dict_of(std::move(shape.recording)); });
  py::dict about;
  for (const auto& [key, text] : shape.about) about[file_text(key)] = file_text(text);
  fields["about"] = about;
  return fields;
}

void bind_form(py::module_& module) {
  module.def("form_image", &image_of, py::arg("shape"), py::arg("truths"), py::arg("about"));
  module.def("read_form", &fields_of_bytes, py::arg("data"), py::arg("name"));
  module.def("form_of_arrays", &fields_of_arrays, py::arg("arrays"), py::arg("name"));
}

}  // namespace salbench::python
