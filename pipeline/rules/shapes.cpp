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

// Key text of an item: everything besides its files that determines its shape.
KeyText key_of_item(const Inputs& inputs) {
  return {"item", [units = inputs.units](Unit unit) { return std::optional(item_of(units, unit).key); }};
}

// Ground truth of an item, imported with its shape, or read from its files; `measured` reads those that are
// not in the HDF5 form.
template <class Measured>
GroundTruth truth_in(const ShapeInForm* imported, const ItemReader& reader, const Mesh& mesh,
                     const Files& files, const Measured& measured) {
  if (imported != nullptr) return given_truth(mesh, *imported, files);
  if (const auto form = reader.form(files, true)) return given_truth(mesh, *form, files);
  return given_truth(mesh, {.truths = {{.view = item_of(files.source).view, .truth = measured()}}}, files);
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
  return table.add(
      kMeshes, stage(Role::shape, 2, "mesh"),
      [reader = source.reader](const ShapeInForm* imported, const Files& files, const Remark& remark) {
        if (imported != nullptr) return usable_mesh(imported->mesh, imported->polygons, files.name, remark);
        ShapeInForm shape = reader->shape(files, false);
        return usable_mesh(std::move(shape.mesh), shape.polygons, files.name, remark);
      },
      form, source.files_read(), kRemark);
}

Output<PointCloud> add_points(RuleTable& table, const Source& source, const Output<ShapeInForm>& form) {
  return table.add(
      kClouds, stage(Role::shape, 1, "cloud"),
      [reader = source.reader](const ShapeInForm* imported, const Files& files, const Remark& remark) {
        return usable_cloud(imported != nullptr ? imported->cloud : reader->shape(files, true).cloud,
                            files.name, remark);
      },
      form, source.files_read(), kRemark);
}

Output<GroundTruth> add_mesh_ground_truth(RuleTable& table, const Config& config, const Source& source,
                                          const Output<Mesh>& mesh, const Output<ShapeInForm>& form) {
  const RuleHead head = stage(Role::ground_truth, 1);
  if (config.simulated())
    return table.add(kMeshes, head, simulate_ground_truth, mesh, section("simulation", config.simulation),
                     kRandom);
  return table.add(
      kMeshes, head,
      [reader = source.reader](const Mesh& shape, const ShapeInForm* imported, const Files& files) {
        return truth_in(imported, *reader, shape, files, [&] { return measured_truth(shape, files); });
      },
      mesh, form, files_of(source.inputs.truth_files));
}

Output<GroundTruth> add_face_truth(RuleTable& table, const Source& source, const Output<Mesh>& mesh,
                                   const Output<ShapeInForm>& form) {
  return table.add(
      kMeshes, stage(Role::ground_truth, 1, kFaceTruth),
      [reader = source.reader](const Mesh& shape, const ShapeInForm* imported, const Files& files) {
        if (imported != nullptr) return given_face_truth(shape, *imported, files);
        const ShapeInForm without_faces = {.truths = {{.view = item_of(files.source).view}}};
        return given_face_truth(shape, reader->form(files, true).value_or(without_faces), files);
      },
      mesh, form, files_of(source.inputs.truth_files));
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
  if (config.simulated())
    return table.add(kClouds, head, made_up_cloud_ground_truth, cloud, surface,
                     section("simulation", config.simulation), kRandom);
  return table.add(
      kClouds, head,
      [reader = source.reader](const PointCloud& points, Surface faces, const ShapeInForm* imported,
                               const Files& files) {
        return truth_in(imported, *reader, mesh_of(points, faces), files,
                        [&] { return measured_cloud_truth(points, files); });
      },
      cloud, surface, form, files_of(source.inputs.truth_files));
}

}  // namespace salbench
