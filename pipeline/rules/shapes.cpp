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

// Key text of an item: everything beside its files that its shape depends on.
KeyText key_of_item(const Inputs& inputs) {
  return {"item", [units = inputs.units](Unit unit) { return std::optional(item_of(units, unit).key); }};
}

// Of the shape its ground truth alone, which `measured` reads if it is in another form.
template <class Measured>
ShapeInForm own_truth(const ItemReader& reader, const Files& files, const Measured& measured) {
  if (auto in_form = reader.form(files, true)) return std::move(*in_form);
  return {.truths = {{.view = item_of(files.source).view, .truth = measured()}}};
}

}  // namespace

Output<ShapeInForm> add_import(RuleTable& table, Level level, const Source& source) {
  return table.add(
      level, stage(Role::import, source.inputs.version),
      [reader = source.reader](const Files& files, const UnitText&, const Remark& remark) {
        ShapeInForm shape = reader->read(files);
        remark.text = shape.remark;
        if (!remark.text.empty()) spdlog::warn("{}: {}", files.name, remark.text);
        return shape;
      },
      files_of(source.inputs.shape_files), text_of(key_of_item(source.inputs)), kRemark);
}

Output<Mesh> add_mesh(RuleTable& table, const Source& source, const Output<ShapeInForm>& form) {
  const RuleHead head = stage(Role::shape, 2, "mesh");
  if (source.is_of_front())
    return table.add(
        kMeshes, head,
        [](const ShapeInForm& shape, const UnitName& name, const Remark& remark) {
          return usable_mesh(shape.mesh, shape.polygons, name.text, remark);
        },
        form, kName, kRemark);
  return table.add(
      kMeshes, head,
      [reader = source.reader](const Files& files, const Remark& remark) {
        ShapeInForm shape = reader->shape(files, false);
        return usable_mesh(std::move(shape.mesh), shape.polygons, files.name, remark);
      },
      files_of(source.inputs.shape_files), kRemark);
}

Output<PointCloud> add_points(RuleTable& table, const Source& source, const Output<ShapeInForm>& form) {
  const RuleHead head = stage(Role::shape, 1, "cloud");
  if (source.is_of_front())
    return table.add(
        kClouds, head,
        [](const ShapeInForm& shape, const UnitName& name, const Remark& remark) {
          return usable_cloud(shape.cloud, name.text, remark);
        },
        form, kName, kRemark);
  return table.add(
      kClouds, head,
      [reader = source.reader](const Files& files, const Remark& remark) {
        return usable_cloud(reader->shape(files, true).cloud, files.name, remark);
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
  if (source.is_of_front()) return table.add(kMeshes, head, given_truth, mesh, form, files);
  return table.add(
      kMeshes, head,
      [reader = source.reader](const Mesh& shape, const Files& given) {
        const auto measured = [&] { return measured_truth(shape, given); };
        return given_truth(shape, own_truth(*reader, given, measured), given);
      },
      mesh, files);
}

Output<GroundTruth> add_face_truth(RuleTable& table, const Source& source, const Output<Mesh>& mesh,
                                   const Output<ShapeInForm>& form) {
  const RuleHead head = stage(Role::ground_truth, 1, kFaceTruth);
  const auto files = files_of(source.inputs.truth_files);
  if (source.is_of_front()) return table.add(kMeshes, head, given_face_truth, mesh, form, files);
  return table.add(
      kMeshes, head,
      [reader = source.reader](const Mesh& shape, const Files& given) {
        const auto none_of_faces = [] { return GroundTruth(); };
        return given_face_truth(shape, own_truth(*reader, given, none_of_faces), given);
      },
      mesh, files);
}

Output<GroundTruth> add_face_truth(RuleTable& table, const Source& source, const Output<PointCloud>& cloud) {
  return table.add(
      kClouds, stage(Role::ground_truth, 1, kFaceTruth),
      [](const PointCloud&, const Files& files) -> GroundTruth {
        throw InputError(
            fmt::format("{}: a point cloud has no faces to score; write dataset: {{score_on: vertices}}",
                        item_of(files.source).file));
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
  if (source.is_of_front())
    return table.add(
        kClouds, head,
        [](const PointCloud& points, Surface faces, const ShapeInForm& shape, const Files& given) {
          return given_truth(mesh_of(points, faces), shape, given);
        },
        cloud, surface, form, files);
  return table.add(
      kClouds, head,
      [reader = source.reader](const PointCloud& points, Surface faces, const Files& given) {
        const auto measured = [&] { return measured_cloud_truth(points, given); };
        return given_truth(mesh_of(points, faces), own_truth(*reader, given, measured), given);
      },
      cloud, surface, files);
}

}  // namespace salbench
