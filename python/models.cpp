// SPDX-License-Identifier: GPL-3.0-or-later
// The table of models on arrays (pipeline/rules/models.h). A model is called by the rule that its row makes
// for a run, so that a new row needs nothing here; what the rule reads and nobody has given is computed as a
// run does it.
#include "pipeline/rules/models.h"

#include <array>

#include "pipeline/inputs/inputs.h"
#include "pipeline/inputs/loading.h"
#include "pipeline/rules/config.h"
#include "python/arrays.h"
#include "python/computing.h"
#include "python/module.h"
#include "python/options.h"
#include "stages/core/errors.h"
#include "stages/fpfh/fpfh.h"
#include "stages/normals/normals.h"
#include "stages/surface/surface.h"

namespace salbench::python {
namespace {

// What a model may read, as its rule numbers it.
enum ShapePart : std::size_t { kPoints, kNormals, kSurface, kFpfh };
constexpr std::array<const char*, 4> kPartNames = {"points", "normals", "faces", "fpfh"};

Rule rule_of(const Model& model, Level level) {
  RuleTable table;
  model.add_map(table, {.level = level,
                        .points = Output<PointCloud>(kPoints),
                        .normals = Output<Normals>(kNormals),
                        .surface = Output<Faces>(kSurface),
                        .fpfh = Output<Descriptors>(kFpfh)});
  return table.rules().front();
}

// A shape whose other parts are made when they are asked for, with the default options of a run.
class LazyShape {
 public:
  LazyShape(PointCloud cloud, Level level) : level_(level), parts_{held(std::move(cloud))} {}

  template <class T>
  void give(ShapePart part, T value) {
    parts_[part] = held(std::move(value));
  }

  ValuePtr operator[](std::size_t part) {
    if (parts_[part] == nullptr) parts_[part] = made(static_cast<ShapePart>(part));
    return parts_[part];
  }

 private:
  template <class T>
  const T& get(ShapePart part) {
    return value_as<T>(*(*this)[part]);
  }

  ValuePtr made(ShapePart part) {
    const auto& cloud = get<PointCloud>(kPoints);
    switch (part) {
      case kNormals:
        return held(parts_[kSurface] != nullptr && level_ == kMeshes
                        ? mesh_normals(mesh_of(cloud, get<Faces>(kSurface)))
                        : cloud_normals(cloud));
      case kSurface:
        return held(partial_mesh(cloud.points, get<Normals>(kNormals)));
      default:
        return held(
            fpfh(cloud.points, get<Normals>(kNormals), level_ == kScans ? ScanFpfhOptions() : FpfhOptions()));
    }
  }

  Level level_;
  std::array<ValuePtr, kPartNames.size()> parts_;
};

const ModelRow& row_of(const std::string& name) {
  std::vector<std::string_view> known;
  for (const ModelRow& row : model_rows()) {
    if (row.name == name) return row;
    known.push_back(row.name);
  }
  fail_unknown("model", name, known);
}

Model bound(const ModelRow& row, const py::dict& keywords, const std::string& function) {
  const Model model = row.bind(Section::from_text("", function), Protocol::published);
  if (keywords.empty()) return model;
  std::vector<std::string_view> known;
  for (const OptionRow& option : model.option_rows) known.push_back(option.name);
  const Section section = section_of(keywords, function, known);
  try {
    return row.bind(section, Protocol::published);
  } catch (const SectionError& error) {
    rethrow(error, function);
  }
}

py::array map_in_memory(const std::string& name, const std::string& function, py::handle points_of,
                        py::handle faces_of, py::handle normals_of, py::handle fpfh_of, py::handle camera,
                        bool is_scan, py::handle seed, const std::string& item, py::handle threads,
                        const py::dict& keywords) {
  const Model model = bound(row_of(name), keywords, function);
  const auto place_of = points(required(points_of, "points"));
  const std::size_t n = place_of.size();
  if (n == 0) throw py::value_error("points must have at least one");
  PointCloud cloud{.points = {place_of.values.begin(), place_of.values.end()}};
  if (!camera.is_none()) cloud.viewpoint = place({camera, "camera"});
  const Level level = is_scan ? kScans : kMeshes;
  LazyShape shape(std::move(cloud), level);
  if (!faces_of.is_none()) shape.give(kSurface, faces({faces_of, "faces"}, n));
  if (!normals_of.is_none()) {
    const auto given = normals({normals_of, "normals"}, n);
    shape.give(kNormals, Normals(given.values.begin(), given.values.end()));
  }
  if (!fpfh_of.is_none()) shape.give(kFpfh, descriptors({fpfh_of, "fpfh"}, n));
  const RandomSource random{whole_number({seed, "seed"}, 0, UINT64_MAX), item};
  const auto most = static_cast<int>(whole_number({threads, "threads"}, 1, kMostThreads));
  const ValuePtr map = computed(most, [&] {
    const Rule rule = rule_of(model, level);
    JobInputs inputs{.random = random};
    for (const std::size_t part : rule.inputs) inputs.values.push_back(shape[part]);
    return rule.compute(inputs);
  });
  return shown(map, value_as<ScalarField>(*map));
}

// (name, what it reads, whether it draws random numbers, whether it is a reference, options) of each that
// makes maps.
py::list model_table() {
  py::list table;
  for (const ModelRow& row : model_rows()) {
    const Model model = row.bind(Section::from_text("", ""), Protocol::published);
    if (!model.add_map) continue;
    const Rule rule = rule_of(model, kMeshes);
    py::list reads;
    for (const std::size_t part : rule.inputs) reads.append(kPartNames.at(part));
    table.append(
        py::make_tuple(row.name, reads, rule.seeded, row.is_reference, described(model.option_rows)));
  }
  return table;
}

}  // namespace

void bind_models(py::module_& module) {
  module.def("map", &map_in_memory);
  module.def("model_table", &model_table);
  module.def("protocol_configuration", [](const std::string& protocol) {
    return annotated_config_yaml(read_config(Section::from_text("protocol: " + protocol, protocol), ""));
  });
}

}  // namespace salbench::python
