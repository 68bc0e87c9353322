// SPDX-License-Identifier: GPL-3.0-or-later
// The strict readers of shape files, and shapes of data sets as used in a run.
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
#include "python/module.h"
#include "python/shape_rules.h"
#include "python/texts.h"
#include "stages/core/errors.h"
#include "stages/gaze/recording.h"
#include "stages/geometry/smoothing.h"

namespace salbench::python {
namespace {

// Prefixes messages on unusable shapes with their file.
template <class Function>
auto naming(const std::string& file, const Function& function) {
  try {
    return function();
  } catch (const ShapeError& error) {
    throw FileError(file, error.what());
  }
}

// --- files ------------------------------------------------------------------------------------------------

// Arrays and, for polygons, the file's face of which each triangle is a part.
py::tuple mesh_of_bytes(const py::bytes& data, const std::string& name) {
  const std::string_view bytes = data;
  ShapeInForm shape;
  shape.mesh = computed([&] { return parse_mesh(bytes, name, &shape.polygons); });
  py::object face_of = py::none();
  if (shape.polygons.split > 0) face_of = moved(faces_of_triangles(shape.polygons, shape.mesh.faces.size()));
  return py::make_tuple(dict_of(shape), face_of);
}

py::dict checked_cloud(PointCloud cloud, const std::string& name) {
  return dict_of(computed([&] {
    return naming(
        name, [&] { return ShapeInForm{.is_cloud = true, .cloud = check_cloud(std::move(cloud)).cloud}; });
  }));
}

py::dict ply_cloud_of_bytes(const py::bytes& data, const std::string& name) {
  const std::string_view bytes = data;
  return checked_cloud(computed([&] { return parse_ply_cloud(bytes, name); }), name);
}

// Rows with NaN coordinates, such as padding, are dropped.
py::dict cloud_of_rows(py::handle points_of, py::handle normals_of, const std::string& name) {
  PointCloud cloud{.points = vectors({points_of, "points"}).copy()};
  cloud.normals = vectors({normals_of, "normals"}, cloud.points.size()).copy();
  return checked_cloud(std::move(cloud), name);
}

std::string digest_of(const py::bytes& data) {
  const std::string_view bytes = data;
  return computed([&] { return xxh128(bytes).hex(); });
}

// --- shapes as used in a run ------------------------------------------------------------------------------

// The mesh of a shape; for a point cloud, the partial mesh over its points.
Mesh surface_mesh(const ShapeInForm& shape) {
  if (!shape.is_cloud) return shape.mesh;
  ShapeRules rules({}, kClouds, held(shape.cloud));
  return mesh_of(shape.cloud, value_as<Faces>(*rules.value(Role::surface)));
}

// Ground truth from a gaze recording, with a configuration's default options.
TruthInForm truth_of_gaze(const ShapeInForm& usable) {
  const Mesh mesh = surface_mesh(usable);
  const GazeOptions options;
  const GazeHits hits = hits_of(mesh, fixations_of(usable.recording, mesh, options.fixations), options.hits);
  return {.truth = gaze_ground_truth(mesh, hits, nullptr, options.truth)};
}

// `view`: view of the ground truth; nullopt: without ground truth.
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
    // The default spread is an angle, which needs the position of the eye.
    if (from_gaze && !shape.recording.origins.empty()) shape.truths.push_back(truth_of_gaze(shape));
    for (TruthInForm& truth : shape.truths)
      if (truth.truth.saliency.empty())
        truth.truth.saliency = smoothed_picks(surface_mesh(shape), truth.truth.picks);
    return std::move(shape);
  });
}

// Arrays of a shape after the checks of a run. `view`: view of the ground truth; None: without ground truth.
py::dict finished(const py::dict& arrays, const std::optional<std::string>& view, const std::string& item,
                  const std::string& file) {
  ShapeInForm shape = shape_from(arrays, file);
  return dict_of(computed(1, [&] {
    std::string remark;
    return usable(std::move(shape), view, item, file, remark);
  }));
}

// Points, faces, diagonal of the bounding box, and remark of a shape after the checks of a run.
py::tuple shape_facts(const py::dict& arrays, const std::string& item, const std::string& file) {
  ShapeInForm shape = shape_from(arrays, file);
  std::string remark;
  shape = computed(1, [&] { return usable(std::move(shape), {}, item, file, remark); });
  const std::vector<Vec3>& points = shape.is_cloud ? shape.cloud.points : shape.mesh.vertices;
  Eigen::AlignedBox3d box;
  for (const Vec3& point : points) box.extend(point);
  return py::make_tuple(points.size(), shape.mesh.faces.size(), box.diagonal().norm(), remark);
}

// Counts of fixations per person, and a remark on people whose gaze never meets the shape.
py::tuple gaze_facts(const py::dict& arrays, double snap, const std::string& file) {
  const ShapeInForm shape = shape_from(arrays, file);
  const auto [hits, remark] = computed(1, [&] {
    const Mesh mesh = surface_mesh(shape);
    GazeHits found = hits_of(mesh, fixations_of(shape.recording, mesh, {}), {.rays = {.snap = snap}});
    std::string remarked = remark_on_people(found, mesh);
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

// Mesh as in its file, or cloud, with values per point and picks per participant: an Item of a set that C++
// reads.
ShapeInForm native_shape(const Item& item) {
  const std::vector<FileData> of_shape = {File{.name = {}, .place = item.file}.read()};
  std::vector<File> files = truth_files_of(item);
  const std::vector<FileData> of_truth = read_files(files);
  const std::any source = item;
  const Files shape_file{source, item.name, of_shape}, truth_files{source, item.name, of_truth};
  ShapeInForm shape = ItemReader(python_front()).shape(shape_file, holds_cloud(item, of_shape[0].text()));
  if (shape.is_cloud) shape.cloud = check_cloud(std::move(shape.cloud)).cloud;
  if (!of_truth.empty())
    shape.truths.push_back({.truth = shape.is_cloud ? measured_cloud_truth(shape.cloud, truth_files)
                                                    : measured_truth(shape.mesh, truth_files)});
  return shape;
}

// Throws FileError instead of ShapeError.
py::dict native_arrays(py::handle given) {
  const Item item = item_from(given, ReadBy::salbench);
  return dict_of(computed(1, [&] { return naming(item.file, [&] { return native_shape(item); }); }));
}

}  // namespace

void bind_reading(py::module_& module) {
  module.def("read_mesh", &mesh_of_bytes, py::arg("data"), py::arg("name"));
  module.def("read_cloud", &ply_cloud_of_bytes, py::arg("data"), py::arg("name"));
  module.def("checked_cloud", &cloud_of_rows, py::arg("points"), py::arg("normals"), py::arg("name"));
  module.def("xxh128", &digest_of, py::arg("data"));
  py::class_<Hasher>(module, "Xxh128")
      .def(py::init<>())
      .def("add", [](Hasher& hasher, const py::bytes& part) { hasher.add_part(std::string_view(part)); })
      .def("hex", [](const Hasher& hasher) { return hasher.digest().hex(); });
  module.def("native_shape", &native_arrays, py::arg("item"));
  module.def("finished", &finished, py::arg("arrays"), py::arg("view"), py::arg("item"), py::arg("file"));
  module.def("shape_facts", &shape_facts, py::arg("arrays"), py::arg("item"), py::arg("file"));
  module.def("gaze_facts", &gaze_facts, py::arg("arrays"), py::arg("snap"), py::arg("file"));
}

}  // namespace salbench::python
