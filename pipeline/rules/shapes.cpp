// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/shapes.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "pipeline/inputs/given_truth.h"
#include "pipeline/inputs/loading.h"
#include "pipeline/rules/models.h"
#include "stages/core/errors.h"
#include "stages/geometry/point_cloud.h"
#include "stages/ground_truth/simulation.h"

namespace salbench {
namespace {

GroundTruth simulate_ground_truth(const Mesh& mesh, const SimulationOptions& options,
                                  const RandomSource& random) {
  return simulated_ground_truth(mesh, options, random.seed, random.item);
}

GroundTruth made_up_cloud_ground_truth(const PointCloud& cloud, Surface surface,
                                       const SimulationOptions& options, const RandomSource& random) {
  return simulate_ground_truth(mesh_of(cloud, surface), options, random);
}

// What its importer could not use of the shape's files, on one line.
std::string remarks_of(const ShapeInForm& shape) {
  const auto told = std::ranges::find(shape.about, "remarks", &TextAttributes::value_type::first);
  if (told == shape.about.end()) return {};
  std::string line = told->second;
  for (std::size_t end = 0; (end = line.find('\n', end)) != std::string::npos;) line.replace(end, 1, "; ");
  return line;
}

// Where the data set has no importer: what an item's own files hold, in the one form or in another.
ShapeInForm own_shape(const Importer& importer, const Files& files, bool is_cloud) {
  auto in_form = importer.form_in(files, false);
  return in_form ? std::move(*in_form) : shape_in_file(files, is_cloud);
}

// Of the shape its ground truth alone, which `measured` reads if it is in another form.
template <class Measured>
ShapeInForm own_truth(const Importer& importer, const Files& files, const Measured& measured) {
  if (auto in_form = importer.form_in(files, true)) return std::move(*in_form);
  return {.truths = {{.view = item_of(files.source).view, .truth = measured()}}};
}

}  // namespace

Output<ShapeInForm> add_import(RuleTable& table, Level level, const Source& source) {
  return table.add(
      level, stage(Role::import, source.inputs.importer.version),
      [importer = source.importer](const Files& files, const Remark& remark) {
        ShapeInForm shape = importer->item(files);
        remark.text = remarks_of(shape);
        if (!remark.text.empty()) spdlog::warn("{}: {}", files.name, remark.text);
        return shape;
      },
      files_of(source.inputs.shape_files), kRemark);
}

Output<Mesh> add_mesh(RuleTable& table, const Source& source, const Output<ShapeInForm>& form) {
  const RuleHead head = stage(Role::shape, 2, "mesh");
  if (source.imports())
    return table.add(
        kMeshes, head,
        [](const ShapeInForm& shape, const UnitName& name, const Remark& remark) {
          return usable_mesh(shape.mesh, shape.polygons, name.text, remark);
        },
        form, kName, kRemark);
  return table.add(
      kMeshes, head,
      [importer = source.importer](const Files& files, const Remark& remark) {
        ShapeInForm shape = own_shape(*importer, files, false);
        return usable_mesh(std::move(shape.mesh), shape.polygons, files.name, remark);
      },
      files_of(source.inputs.shape_files), kRemark);
}

Output<PointCloud> add_points(RuleTable& table, const Source& source, const Output<ShapeInForm>& form) {
  const RuleHead head = stage(Role::shape, 1, "cloud");
  if (source.imports())
    return table.add(
        kClouds, head,
        [](const ShapeInForm& shape, const UnitName& name, const Remark& remark) {
          return usable_cloud(shape.cloud, name.text, remark);
        },
        form, kName, kRemark);
  return table.add(
      kClouds, head,
      [importer = source.importer](const Files& files, const Remark& remark) {
        return usable_cloud(own_shape(*importer, files, true).cloud, files.name, remark);
      },
      files_of(source.inputs.shape_files), kRemark);
}

Output<GroundTruth> add_mesh_ground_truth(RuleTable& table, const Config& config, const Source& source,
                                          const Output<Mesh>& mesh, const Output<ShapeInForm>& form) {
  const RuleHead head = stage(Role::ground_truth, 1);
  const auto files = files_of(source.inputs.truth_files);
  if (config.simulated())
    return table.add(kMeshes, head, simulate_ground_truth, mesh, section("simulation", config.simulation),
                     kRandom);
  if (source.imports()) return table.add(kMeshes, head, given_truth, mesh, form, files);
  return table.add(
      kMeshes, head,
      [importer = source.importer](const Mesh& shape, const Files& given) {
        const auto measured = [&] { return measured_truth(shape, given); };
        return given_truth(shape, own_truth(*importer, given, measured), given);
      },
      mesh, files);
}

Output<GroundTruth> add_face_truth(RuleTable& table, const Source& source, const Output<Mesh>& mesh,
                                   const Output<ShapeInForm>& form) {
  const RuleHead head = stage(Role::ground_truth, 1, kFaceTruth);
  const auto files = files_of(source.inputs.truth_files);
  if (source.imports()) return table.add(kMeshes, head, given_face_truth, mesh, form, files);
  return table.add(
      kMeshes, head,
      [importer = source.importer](const Mesh& shape, const Files& given) {
        const auto none_of_faces = [] { return GroundTruth(); };
        return given_face_truth(shape, own_truth(*importer, given, none_of_faces), given);
      },
      mesh, files);
}

Output<GroundTruth> add_face_truth(RuleTable& table, const Source& source, const Output<PointCloud>& cloud) {
  return table.add(
      kClouds, stage(Role::ground_truth, 1, kFaceTruth),
      [](const PointCloud&, const Files& files) -> GroundTruth {
        throw InputError(
            fmt::format("{}: a point cloud has no faces to score; write dataset: {{score_on: vertices}}",
                        item_of(files.source).mesh));
      },
      cloud, files_of(source.inputs.truth_files));
}

Output<GroundTruth> add_cloud_ground_truth(RuleTable& table, const Config& config, const Source& source,
                                           const Output<PointCloud>& cloud, const Output<Surface>& surface,
                                           const Output<ShapeInForm>& form) {
  const RuleHead head = stage(Role::ground_truth, 1, "cloud_ground_truth");
  const auto files = files_of(source.inputs.truth_files);
  if (config.simulated())
    return table.add(kClouds, head, made_up_cloud_ground_truth, cloud, surface,
                     section("simulation", config.simulation), kRandom);
  if (source.imports())
    return table.add(
        kClouds, head,
        [](const PointCloud& points, Surface faces, const ShapeInForm& shape, const Files& given) {
          return given_truth(mesh_of(points, faces), shape, given);
        },
        cloud, surface, form, files);
  return table.add(
      kClouds, head,
      [importer = source.importer](const PointCloud& points, Surface faces, const Files& given) {
        const auto measured = [&] { return measured_cloud_truth(points, given); };
        return given_truth(mesh_of(points, faces), own_truth(*importer, given, measured), given);
      },
      cloud, surface, files);
}

}  // namespace salbench
