// SPDX-License-Identifier: GPL-3.0-or-later
// Functions of C++ that importers of data sets call: the strict readers, the writer of the one form
// (io/hdf5/one_form.h), and the loader that gives shapes as a run has them.
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "io/digest.h"
#include "io/hdf5/hdf5_file.h"
#include "io/hdf5/one_form.h"
#include "io/hdf5/one_form_index.h"
#include "io/shapes/cloud_file.h"
#include "io/shapes/mesh_file.h"
#include "pipeline/inputs/loading.h"
#include "pipeline/rules/config.h"
#include "python/arrays.h"
#include "python/computing.h"
#include "python/loaded.h"
#include "python/module.h"
#include "stages/core/errors.h"
#include "stages/gaze/recording.h"

namespace salbench::python {
namespace {

// The message of a shape that cannot be used begins with the name of its file.
template <class Function>
auto naming(const std::string& file, const Function& function) {
  try {
    return function();
  } catch (const ShapeError& error) {
    throw FileError(file, error.what());
  }
}

// --- the strict readers -----------------------------------------------------------------------------------

// Points, triangles, polygons and how many of these are concave, and where there are polygons which face of
// the file each triangle is part of.
py::tuple mesh_of_bytes(const py::bytes& data, const std::string& name) {
  const std::string_view bytes = data;
  PolygonCounts polygons;
  Mesh mesh = computed([&] { return parse_mesh(bytes, name, &polygons); });
  py::object face_of = py::none();
  if (polygons.split > 0) face_of = moved(faces_of_triangles(polygons, mesh.faces.size()));
  return py::make_tuple(moved(std::move(mesh.vertices)), moved(std::move(mesh.faces)), polygons.split,
                        polygons.concave, face_of);
}

py::tuple cloud_tuple(PointCloud cloud, const std::string& name) {
  CheckedCloud checked =
      computed([&] { return naming(name, [&] { return check_cloud(std::move(cloud)); }); });
  auto& [points, normals, viewpoint, dropped] = checked.cloud;
  py::object normals_of = py::none(), viewpoint_of = py::none();
  if (!normals.empty()) normals_of = moved(std::move(normals));
  if (viewpoint) viewpoint_of = moved(std::vector<double>(viewpoint->begin(), viewpoint->end()));
  return py::make_tuple(moved(std::move(points)), normals_of, viewpoint_of, moved(std::move(dropped)));
}

py::tuple cloud_of_bytes(const py::bytes& data, const std::string& name) {
  const std::string_view bytes = data;
  return cloud_tuple(computed([&] { return parse_cloud(bytes, name); }), name);
}

std::vector<Vec3> triples_of(py::handle array, const char* name) {
  const auto given = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!given || given.ndim() != 2 || given.shape(1) != 3)
    throw py::value_error(fmt::format("{} must have shape (n, 3)", name));
  const auto* first = reinterpret_cast<const Vec3*>(given.data());
  return {first, first + given.shape(0)};
}

// Rows without a position, such as padding, have NaN there, and are left out.
py::tuple cloud_of_rows(py::handle points_of, py::handle normals_of, const std::string& name) {
  PointCloud cloud{.points = triples_of(points_of, "points")};
  if (!normals_of.is_none()) cloud.normals = triples_of(normals_of, "normals");
  if (!cloud.normals.empty() && cloud.normals.size() != cloud.points.size())
    throw py::value_error("normals must be as many as points");
  return cloud_tuple(std::move(cloud), name);
}

// --- what is computed from them ---------------------------------------------------------------------------

std::string digest_of(const py::bytes& data) {
  const std::string_view bytes = data;
  return computed([&] { return xxh128(bytes).hex(); });
}

// --- the one form -----------------------------------------------------------------------------------------

ScalarField field_of(py::handle values, const char* name, std::optional<std::size_t> n = {}) {
  if (values.is_none()) return {};
  const auto view = field({values, name}, n);
  return {view.values.begin(), view.values.end()};
}

ValuesAsRead as_read_from(py::handle read) {
  const std::string per = file_bytes(read.attr("per"));
  const std::vector<std::string_view> known = {"vertex", "face", "point"};
  const auto named = std::ranges::find(known, per);
  if (named == known.end()) throw py::value_error("per must be vertex, face or point, not " + per);
  ValuesAsRead values{.file = file_bytes(read.attr("file")),
                      .per = *named,
                      .values = field_of(read.attr("values"), "values")};
  if (const py::object at = read.attr("points"); !at.is_none()) values.points = triples_of(at, "points");
  values.mask = field_of(read.attr("mask"), "mask", values.values.size());
  return values;
}

TruthInForm truth_from(py::handle given, std::size_t n, std::size_t n_faces) {
  TruthInForm truth{.view = file_bytes(given.attr("view"))};
  truth.truth.saliency = field_of(given.attr("saliency"), "saliency", n);
  if (const py::object all = given.attr("viewers"); !all.is_none()) {
    const auto maps = rows({all, "viewers"}, {});
    if (n == 0 || maps.size() % n != 0) throw py::value_error("viewers must have shape (v, n)");
    for (auto row = maps.values.begin(); row != maps.values.end(); row += static_cast<std::ptrdiff_t>(n))
      truth.truth.viewers.emplace_back(row, row + static_cast<std::ptrdiff_t>(n));
  }
  for (const py::handle one : given.attr("picks")) truth.truth.picks.push_back(indices({one, "picks"}, n));
  truth.face_values = field_of(given.attr("face_values"), "face_values", n_faces);
  for (const py::handle read : given.attr("as_read")) truth.as_read.push_back(as_read_from(read));
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

// Of a Form of salbench.datasets.records, or anything with its attributes.
ShapeInForm shape_from(py::handle form) {
  const auto where = points(required(form.attr("points"), "points"));
  std::vector<Vec3> place_of(where.values.begin(), where.values.end());
  ShapeInForm shape{.is_cloud = form.attr("faces").is_none()};
  std::tie(shape.polygons.split, shape.polygons.concave) =
      form.attr("polygons").cast<std::pair<std::int64_t, std::int64_t>>();
  if (shape.is_cloud) {
    shape.cloud.points = std::move(place_of);
    if (const py::object normal_of = form.attr("normals"); !normal_of.is_none()) {
      const auto unit = normals({normal_of, "normals"}, where.size());
      shape.cloud.normals.assign(unit.values.begin(), unit.values.end());
    }
    if (const py::object from = form.attr("viewpoint"); !from.is_none())
      shape.cloud.viewpoint = place({from, "viewpoint"});
    if (const py::object out = form.attr("left_out"); !out.is_none())
      shape.cloud.dropped = indices({out, "left_out"}, where.size() + static_cast<std::size_t>(py::len(out)));
  } else {
    shape.mesh = {std::move(place_of), faces({form.attr("faces"), "faces"}, where.size())};
  }
  for (const py::handle truth : form.attr("truths"))
    shape.truths.push_back(truth_from(truth, where.size(), shape.mesh.faces.size()));
  if (const py::object recording = py::getattr(form, "recording", py::none()); !recording.is_none())
    shape.recording = recording_from(recording);
  for (const auto& [key, text] : form.attr("about").cast<py::dict>())
    shape.about.emplace_back(file_bytes(key), file_bytes(text));
  return shape;
}

py::bytes image_of(py::handle form) {
  const ShapeInForm shape = shape_from(form);
  const Bytes image = computed([&] { return one_form_image(shape); });
  return {reinterpret_cast<const char*>(image.data()), image.size()};
}

py::object or_none(bool given, const auto& array) { return given ? py::object(array()) : py::none(); }

py::dict dict_of(TruthInForm truth, std::size_t n) {
  py::list picked;
  for (std::vector<std::int32_t>& own : truth.truth.picks) picked.append(moved(std::move(own)));
  py::dict fields;
  fields["view"] = file_text(truth.view);
  fields["saliency"] =
      or_none(!truth.truth.saliency.empty(), [&] { return moved(std::move(truth.truth.saliency)); });
  fields["viewers"] = or_none(!truth.truth.viewers.empty(), [&] {
    std::vector<double> all;
    for (const ScalarField& map : truth.truth.viewers) all.insert(all.end(), map.begin(), map.end());
    return moved(std::move(all), {-1, static_cast<py::ssize_t>(n)});
  });
  fields["picks"] = py::tuple(picked);
  fields["face_values"] =
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

// None if no program of ours wrote the bytes.
py::object form_of_bytes(const py::bytes& data, const std::string& name) {
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

// Data sets by their names in the form, as somebody else's file has them, checked: fields of a Form.
py::object form_of_arrays(const py::dict& given, const std::string& name) {
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

using IndexFields =
    std::tuple<py::str, py::str, py::str, py::str, std::string, bool, std::size_t, std::size_t, py::str,
               std::size_t>;  // in the order of the columns

py::list index_rows(const std::string& path) {
  py::list rows;
  for (const IndexRow& row : computed([&] { return read_index(path); }))
    rows.append(IndexFields(file_text(row.shape), file_text(row.view), file_text(row.category),
                            file_text(row.split), row.facts.is_cloud ? "cloud" : "mesh", row.facts.has_truth,
                            row.facts.participants, row.facts.viewers, file_text(row.source),
                            row.facts.recorded));
  return rows;
}

py::bytes index_bytes(const py::list& rows, const py::str& remark) {
  std::vector<IndexRow> all;
  for (const py::handle row : rows) {
    const auto [shape, view, category, split, kind, truth, participants, viewers, source, recorded] =
        row.cast<IndexFields>();
    all.push_back({.shape = file_bytes(shape),
                   .view = file_bytes(view),
                   .category = file_bytes(category),
                   .split = file_bytes(split),
                   .facts = {kind == "cloud", truth, participants, viewers, recorded},
                   .source = file_bytes(source)});
  }
  return py::bytes(index_text(all, file_bytes(remark)));
}

// --- as a run has it --------------------------------------------------------------------------------------

// What a recording of gaze becomes with the options that a configuration has by default.
TruthInForm truth_of_gaze(const ShapeInForm& usable) {
  const Mesh mesh = surface_mesh(usable);
  const GazeOptions options;
  const GazeHits hits = hits_of(mesh, fixations_of(usable.recording, options.fixations), options.hits);
  return {.truth = gaze_ground_truth(mesh, hits, nullptr, options.truth)};
}

// `view`: of the ground truth; nothing: none is asked for.
ShapeInForm usable(ShapeInForm shape, const std::optional<std::string>& view, const std::string& item,
                   const std::string& file, std::string& remark) {
  std::vector<TruthInForm> all = std::exchange(shape.truths, {});
  const auto found = view ? std::ranges::find(all, *view, &TruthInForm::view) : all.end();
  const bool from_gaze = view && found == all.end() && view->empty() && !shape.recording.empty();
  if (found != all.end())
    shape.truths.push_back(std::move(*found));
  else if (view && !from_gaze)
    throw FileError(file, view->empty() ? "has no ground truth" : "has no ground truth of view " + *view);
  return naming(file, [&] {
    if (shape.is_cloud)
      shape.cloud = usable_cloud(std::move(shape.cloud), item, Remark{remark});
    else
      shape.mesh = usable_mesh(std::move(shape.mesh), shape.polygons, item, Remark{remark});
    // Without the place of the eye there is no such default: it is an angle.
    if (from_gaze && !shape.recording.origins.empty()) shape.truths.push_back(truth_of_gaze(shape));
    return with_saliency(std::move(shape));
  });
}

// A Form, or the bytes of one, whose file must be of the shape; None for bytes that no program of ours wrote.
py::object finished(py::handle form, const std::optional<std::string>& view, const std::string& item,
                    const std::string& file, const std::string& shape_name) {
  std::optional<ShapeInForm> given;
  std::string_view bytes;
  if (py::isinstance<py::bytes>(form))
    bytes = py::reinterpret_borrow<py::bytes>(form);
  else
    given = shape_from(form);
  const auto shape = computed(1, [&]() -> std::shared_ptr<const ShapeInForm> {
    if (!shape_name.empty()) require_form_of(shape_name, bytes, file);
    if (!given) given = shape_in_form(bytes, file);
    std::string remark;
    return given ? std::make_shared<ShapeInForm>(usable(std::move(*given), view, item, file, remark))
                 : nullptr;
  });
  return shape ? py::object(arrays_of(shape)) : py::none();
}

// Points, faces, diagonal of the bounding box, and a remark, of a shape that a run can use.
py::tuple shape_facts(py::handle form, const std::string& item, const std::string& file) {
  ShapeInForm shape = shape_from(form);
  std::string remark;
  shape = computed(1, [&] { return usable(std::move(shape), {}, item, file, remark); });
  const std::vector<Vec3>& points = shape.is_cloud ? shape.cloud.points : shape.mesh.vertices;
  Eigen::AlignedBox3d box;
  for (const Vec3& point : points) box.extend(point);
  return py::make_tuple(points.size(), shape.mesh.faces.size(), box.diagonal().norm(), remark);
}

// Counts of fixations by person, and what is to be remarked on people.
py::tuple gaze_facts(py::handle form, double snap) {
  const ShapeInForm shape = shape_from(form);
  const auto [hits, remark] = computed(1, [&] {
    GazeHits found = hits_of(shape.mesh, fixations_of(shape.recording, {}), {.rays = {.snap = snap}});
    std::string remarked = remark_on_people(found);
    return std::pair(std::move(found), std::move(remarked));
  });
  py::list people;
  const std::vector<GazeCounts> counts = counts_by_person(hits);
  for (std::size_t p = 0; p < counts.size(); ++p) {
    py::dict person;
    person["name"] = file_text(hits.people.names[p]);
    person["samples"] = hits.people.samples[p];
    person["lost"] = hits.people.lost[p];
    person["fixations"] = counts[p].fixations;
    person["hits"] = counts[p].hits;
    person["snapped"] = counts[p].snapped;
    person["missed"] = counts[p].fixations - counts[p].hits;
    people.append(person);
  }
  return py::make_tuple(people, remark);
}

}  // namespace

py::dict fields_of(ShapeInForm shape) {
  py::dict fields;
  auto& [place_of, normal_of, viewpoint, dropped] = shape.cloud;
  const std::size_t n = shape.is_cloud ? place_of.size() : shape.mesh.vertices.size();
  py::list truths;
  for (TruthInForm& truth : shape.truths) truths.append(dict_of(std::move(truth), n));
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

void bind_datasets(py::module_& module) {
  module.def("read_mesh", &mesh_of_bytes, py::arg("data"), py::arg("name"));
  module.def("read_cloud", &cloud_of_bytes, py::arg("data"), py::arg("name"));
  module.def("checked_cloud", &cloud_of_rows, py::arg("points"), py::arg("normals"), py::arg("name"));
  module.def("xxh128", &digest_of, py::arg("data"));
  py::class_<Hasher>(module, "Xxh128")
      .def(py::init<>())
      .def("add", [](Hasher& hasher, const py::bytes& part) { hasher.add_part(std::string_view(part)); })
      .def("hex", [](const Hasher& hasher) { return hasher.digest().hex(); });
  module.def("one_form_image", &image_of, py::arg("form"));
  module.def("read_one_form", &form_of_bytes, py::arg("data"), py::arg("name"));
  module.def("form_of_arrays", &form_of_arrays, py::arg("arrays"), py::arg("name"));
  module.def("read_index", &index_rows, py::arg("path"));
  module.def("index_text", &index_bytes, py::arg("rows"), py::arg("remark") = "");
  module.def("shape_facts", &shape_facts, py::arg("form"), py::arg("item"), py::arg("file"));
  module.def("gaze_facts", &gaze_facts, py::arg("form"), py::arg("snap"));
  module.def("finished", &finished, py::arg("form"), py::arg("view"), py::arg("item"), py::arg("file"),
             py::arg("shape") = "");
}

}  // namespace salbench::python
