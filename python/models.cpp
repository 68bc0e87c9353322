// SPDX-License-Identifier: GPL-3.0-or-later
// The table of models on arrays (pipeline/rules/models.h). Models are called through the rules of a run, so
// that a new row needs no change here.
#include "pipeline/rules/models.h"

#include <memory>
#include <optional>

#include <fmt/format.h>

#include "pipeline/rules/config.h"
#include "python/arrays.h"
#include "python/computing.h"
#include "python/module.h"
#include "python/options.h"
#include "python/shape_rules.h"
#include "stages/normals/normals.h"

namespace salbench::python {
namespace {

Model bound(const ModelRow& row, const py::dict& keywords, const std::string& function) {
  const auto bind = [&](const Section& section) { return row.bind(section, Protocol::published); };
  const Model usual = bind(Section::from_text("", function));
  return keywords.empty() ? usual : read_keywords(keywords, function, usual.option_rows, bind);
}

// Points with faces are a mesh; others are a point cloud, or a scan, possibly with unknown camera.
ShapeRules rules_of(const Model& model, const std::vector<Vec3>& points, const std::optional<Faces>& faces,
                    const std::optional<Vec3>& camera, bool is_scan) {
  if (faces && !is_scan) return {{model}, kMeshes, held(Mesh{points, *faces})};
  ShapeRules rules = is_scan ? ShapeRules({model}, kScans, held(Scan{points, camera.value_or(Vec3::Zero())}))
                             : ShapeRules({model}, kClouds, held(PointCloud{.points = points}));
  if (is_scan && !camera)
    rules[Role::normals].compute = [cloud = PointCloud{.points = points}](const JobInputs&) {
      return held(cloud_normals(cloud));
    };
  if (faces) rules.give(Role::surface, held(*faces));
  return rules;
}

py::array map_in_memory(const std::string& name, const std::string& function, py::handle points_of,
                        py::handle faces_of, py::handle normals_of, py::handle fpfh_of, py::handle camera_of,
                        bool is_scan, py::handle seed, const std::string& item, py::handle threads,
                        const py::dict& keywords) {
  const Model model = bound(row_named("model", name, model_rows(), &ModelRow::name), keywords, function);
  const auto place_of = points(required(points_of, "points"));
  const std::size_t n = place_of.size();
  if (n == 0) throw py::value_error("points must have at least one");
  std::optional<Faces> surface;
  std::optional<Vec3> camera;
  if (!camera_of.is_none()) camera = place({camera_of, "camera"});
  if (!faces_of.is_none()) surface = faces({faces_of, "faces"}, place_of.size());
  ShapeRules rules = rules_of(model, place_of.copy(), surface, camera, is_scan);
  if (!normals_of.is_none())
    rules.give(Role::normals, held(Normals(normals({normals_of, "normals"}, n).copy())));
  if (!fpfh_of.is_none()) rules.give(Role::fpfh, held(descriptors({fpfh_of, "fpfh"}, n)));
  const RandomSource random{whole_number({seed, "seed"}, 0, UINT64_MAX), item};
  const auto most = thread_count({threads, "threads"});
  const ValuePtr map = computed(most, [&] { return rules.value(Role::map, random); });
  return shown(map, FieldView(value_as<ScalarField>(*map)));
}

const char* argument_of(Role role) {
  return role == Role::shape ? "points" : role == Role::surface ? "faces" : name_of(role).data();
}

// (name, inputs, draws random numbers, is a reference, options) of each model that computes maps.
py::list model_table() {
  py::list table;
  for (const ModelRow& row : model_rows()) {
    const Model model = row.bind(Section::from_text("", ""), Protocol::published);
    if (!model.add_map) continue;
    ShapeRules rules({model}, kClouds, nullptr);  // a mesh would include its faces
    const Rule& rule = rules[Role::map];
    py::list reads;
    for (const std::size_t input : rule.inputs) reads.append(argument_of(rules.role(input)));
    table.append(
        py::make_tuple(row.name, reads, rule.seeded, row.about.is_reference, described(model.option_rows)));
  }
  return table;
}

// Descriptions by name for pages, tables and docstrings, including models without a function.
py::dict models_about() {
  py::dict about;
  for (const ModelRow& row : model_rows()) about[py::cast(row.name)] = row.about;
  about[py::cast(kConstantMap)] = kConstantAbout;
  return about;
}

void bind_about(py::module_& module) {
  py::class_<ModelAbout>(module, "ModelAbout")
      .def_readonly("name", &ModelAbout::name)
      .def_readonly("link", &ModelAbout::link)
      .def_readonly("key", &ModelAbout::key)
      .def_readonly("is_reference", &ModelAbout::is_reference)
      .def_readonly("is_floor", &ModelAbout::is_floor)
      .def_property_readonly("source",
                             [](const ModelAbout& about) {
                               return fmt::format("{}{}{}", about.authors, about.year.empty() ? "" : " ",
                                                  about.year);
                             })
      .def_property_readonly(
          "summary", [](const ModelAbout& about) { return fmt::format("{}{}.", about.name, about.values); });
  module.attr("models_about") = models_about();
}

}  // namespace

void bind_models(py::module_& module) {
  bind_about(module);
  module.def("map", &map_in_memory);
  module.def("model_table", &model_table);
  module.def("protocol_configuration", [](const std::string& protocol) {
    return annotated_config_yaml(read_config(Section::from_text("protocol: " + protocol, protocol), ""));
  });
}

}  // namespace salbench::python
