// SPDX-License-Identifier: GPL-3.0-or-later
// The strict readers of shape files, and shapes of data sets as a run has them.
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "io/digest.h"
#include "io/shapes/cloud_file.h"
#include "io/shapes/mesh_file.h"
#include "pipeline/inputs/given_truth.h"
#include "pipeline/inputs/item_reader.h"
#include "pipeline/inputs/loading.h"
#include "pipeline/rules/config.h"
#include "python/arrays.h"
#include "python/computing.h"
#include "python/form.h"
#include "python/front.h"
#include "python/items.h"
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

// --- files ------------------------------------------------------------------------------------------------

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

py::tuple ply_cloud_of_bytes(const py::bytes& data, const std::string& name) {
  const std::string_view bytes = data;
  return cloud_tuple(computed([&] { return parse_ply_cloud(bytes, name); }), name);
}

// Rows without a position, such as padding, have NaN there, and are left out.
py::tuple cloud_of_rows(py::handle points_of, py::handle normals_of, const std::string& name,
                        py::handle viewpoint) {
  PointCloud cloud{.points = triples_of(points_of, "points")};
  if (!normals_of.is_none()) cloud.normals = triples_of(normals_of, "normals");
  if (!cloud.normals.empty() && cloud.normals.size() != cloud.points.size())
    throw py::value_error("normals must be as many as points");
  if (!viewpoint.is_none()) cloud.viewpoint = place({viewpoint, "viewpoint"});
  return cloud_tuple(std::move(cloud), name);
}

std::string digest_of(const py::bytes& data) {
  const std::string_view bytes = data;
  return computed([&] { return xxh128(bytes).hex(); });
}

// --- as a run has it --------------------------------------------------------------------------------------

// Ground truth from a recording of gaze, with the default options of a configuration.
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

// A Shape, or the bytes of a file in the HDF5 form, which must be of the shape named; None for bytes that no
// program of ours wrote. `view`: of the ground truth; None: none is asked for.
py::object finished(py::handle form, const std::optional<std::string>& view, const std::string& item,
                    const std::string& file, const std::string& shape_name) {
  std::optional<ShapeInForm> given;
  std::string_view bytes;
  if (py::isinstance<py::bytes>(form))
    bytes = py::reinterpret_borrow<py::bytes>(form);
  else
    given = shape_from(form, view.value_or(""));
  const auto shape = computed(1, [&]() -> std::shared_ptr<const ShapeInForm> {
    if (!shape_name.empty()) require_form_of(shape_name, bytes, file);
    given = given ? shape_in_arrays(one_form_arrays(*given), file) : shape_in_form(bytes, file);
    std::string remark;
    return given ? std::make_shared<ShapeInForm>(usable(std::move(*given), view, item, file, remark))
                 : nullptr;
  });
  return shape ? py::object(arrays_of(shape)) : py::none();
}

// Points, faces, diagonal of the bounding box, and a remark, of a shape that a run can use.
py::tuple shape_facts(py::handle form, const std::string& item, const std::string& file) {
  ShapeInForm shape = shape_from(form, "");
  std::string remark;
  shape = computed(1, [&] { return usable(std::move(shape), {}, item, file, remark); });
  const std::vector<Vec3>& points = shape.is_cloud ? shape.cloud.points : shape.mesh.vertices;
  Eigen::AlignedBox3d box;
  for (const Vec3& point : points) box.extend(point);
  return py::make_tuple(points.size(), shape.mesh.faces.size(), box.diagonal().norm(), remark);
}

// Counts of fixations by person, and what is to be remarked on people.
py::tuple gaze_facts(py::handle form, double snap) {
  const ShapeInForm shape = shape_from(form, "");
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

// Reads a mesh or a cloud, with values per point and picks per participant. `as_written`: the mesh as its
// file has it.
ShapeInForm native_shape(const Item& item, bool as_written) {
  const std::vector<FileData> of_shape = {File{.name = {}, .place = item.file}.read()};
  std::vector<File> files = truth_files_of(item);
  const std::vector<FileData> of_truth = read_files(files);
  const std::any source = item;
  const Files shape_file{source, item.name, of_shape}, truth_files{source, item.name, of_truth};
  ShapeInForm shape = ItemReader(python_front()).shape(shape_file, holds_cloud(item, of_shape[0].text()));
  std::string remark;
  if (shape.is_cloud)
    shape.cloud = usable_cloud(std::move(shape.cloud), item.name, Remark{remark});
  else if (!as_written)
    shape.mesh = usable_mesh(std::move(shape.mesh), shape.polygons, item.name, Remark{remark});
  if (!of_truth.empty())
    shape.truths.push_back({.truth = shape.is_cloud ? measured_cloud_truth(shape.cloud, truth_files)
                                                    : measured_truth(shape.mesh, truth_files)});
  return shape;
}

// Of an Item of a set that C++ reads. Throws FileError in place of ShapeError.
py::tuple load_native(py::handle given) {
  const Item item = item_from(given, ReadBy::salbench);
  return arrays_of(computed(1, [&] {
    return naming(item.file, [&] {
      return std::make_shared<const ShapeInForm>(with_saliency(native_shape(item, false)));
    });
  }));
}

// Fields of a Shape, its mesh as the file has it, and no saliency made from picks.
py::dict native_fields(py::handle given) {
  const Item item = item_from(given, ReadBy::salbench);
  return fields_of(computed(1, [&] { return native_shape(item, true); }));
}

}  // namespace

void bind_reading(py::module_& module) {
  module.def("read_mesh", &mesh_of_bytes, py::arg("data"), py::arg("name"));
  module.def("read_cloud", &ply_cloud_of_bytes, py::arg("data"), py::arg("name"));
  module.def("checked_cloud", &cloud_of_rows, py::arg("points"), py::arg("normals"), py::arg("name"),
             py::arg("viewpoint") = py::none());
  module.def("xxh128", &digest_of, py::arg("data"));
  py::class_<Hasher>(module, "Xxh128")
      .def(py::init<>())
      .def("add", [](Hasher& hasher, const py::bytes& part) { hasher.add_part(std::string_view(part)); })
      .def("hex", [](const Hasher& hasher) { return hasher.digest().hex(); });
  module.def("load_native", &load_native, py::arg("item"));
  module.def("native_shape", &native_fields, py::arg("item"));
  module.def("finished", &finished, py::arg("shape"), py::arg("view"), py::arg("item"), py::arg("file"),
             py::arg("shape_name") = "");
  module.def("shape_facts", &shape_facts, py::arg("shape"), py::arg("item"), py::arg("file"));
  module.def("gaze_facts", &gaze_facts, py::arg("shape"), py::arg("snap"));
}

}  // namespace salbench::python
