// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/rules.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "pipeline/rules/gaze.h"
#include "pipeline/rules/human.h"
#include "pipeline/rules/scoring.h"
#include "pipeline/rules/shapes.h"
#include "stages/ground_truth/carried.h"
#include "stages/picture/picture.h"

namespace salbench {
namespace {

// --- functions of rules that are more than one stage's ----------------------------------------------------

Scan scan_of(const ScanScene& scene, const UnitPlace& view, const ScanOptions& options) {
  return scene.scan(static_cast<int>(view.index), options);
}

// --- groups of rules ---------------------------------------------------------------------------------------

Output<Descriptors> add_fpfh(RuleTable& table, const ShapeOutputs& shape,
                             const SectionOf<FpfhOptions>& chosen) {
  const auto describe = [](Points points, const Normals& normals, const FpfhOptions& options) {
    return fpfh(points, normals, options);
  };
  return table.add(shape.level, stage(Role::fpfh, 1), describe, shape.points, shape.normals, chosen);
}

// From its points on, a cloud is described like the vertices of a mesh: with the same normals, both have the
// same maps. What needs faces takes a partial mesh, as for scans.
Output<PointCloud> add_cloud(RuleTable& table, const Config& config, const Source& source,
                             const std::optional<Histogram>& given, ShapeOutputs& clouds) {
  const auto form = source.imports() ? add_import(table, kClouds, source) : Output<ShapeInForm>();
  const Output<PointCloud> cloud = add_points(table, source, form);
  clouds.points = clouds.cloud = cloud;
  const Output<Normals> normals = table.add(kClouds, stage(Role::normals, 1, "cloud_normals"), cloud_normals,
                                            cloud, section("scan_normals", config.scan_normals));
  clouds.normals = normals;
  clouds.surface = table.add(kClouds, stage(Role::surface, 1), partial_mesh, cloud, normals,
                             section("surface", config.surface));
  if (config.on_faces())
    clouds.ground_truth = add_face_truth(table, source, cloud);
  else if (config.recorded())
    clouds.ground_truth = add_gaze_truth(table, config, source, cloud, clouds.surface, form);
  else
    clouds.ground_truth = add_cloud_ground_truth(table, config, source, cloud, clouds.surface, form);
  clouds.reference = add_reference(table, kClouds, clouds.ground_truth, given);
  clouds.fpfh = add_fpfh(table, clouds, section("fpfh", config.fpfh));
  return cloud;
}

template <class Function, class... Arguments>
void add_picture(RuleTable& table, const Config& config, Level level, const Function& picture,
                 const Arguments&... arguments) {
  RuleHead head = stage(Role::picture, 2);
  head.only_if_cached = config.pictures == Pictures::cached;
  table.add(level, head, picture, arguments..., section("picture", config.picture), kRandom);
}

// The files that each shape was read from, textures among them.
FilesOfUnits originals_of(const Inputs& inputs, Level level) {
  auto files = std::make_shared<std::vector<std::vector<File>>>(inputs.units.slots(level));
  if (inputs.shape_files)
    for (const Unit unit : inputs.units.of(level))
      (*files)[unit.index] = inputs.shape_files->at(inputs.units.family_of(unit));
  return files;
}

// What shapes are, and how they look; all else is made of them.
constexpr std::array kOfShapes = {Role::import,    Role::shape,          Role::fixations,
                                  Role::gaze_hits, Role::visible_shares, Role::ground_truth,
                                  Role::normals,   Role::surface,        Role::picture};

void give_map_files(const std::vector<ShapeOutputs*>& shapes, const Units& units,
                    const std::shared_ptr<const GivenMaps>& maps) {
  std::vector<Level> levels;
  for (const ShapeOutputs* shape : shapes) levels.push_back(shape->level);
  const bool on_faces = std::ranges::any_of(shapes, &ShapeOutputs::on_faces);
  const auto files = map_files(maps, units, levels, on_faces);
  for (ShapeOutputs* shape : shapes) shape->map_files = files.at(shape->level);
}

}  // namespace

Rules make_rules(const Config& with_smoothing, const Inputs& inputs,
                 const std::optional<Histogram>& given_reference) {
  Config config = with_smoothing;  // plain scores are the same with it and without
  config.metrics.smoothing.clear();
  if (is_from_gaze(config, inputs)) config.dataset.participants = Participants::recorded;
  RuleTable table;
  ShapeOutputs meshes{.level = kMeshes}, scans{.level = kScans}, clouds{.level = kClouds};
  const bool any_mesh = inputs.has(kMeshes), any_cloud = inputs.has(kClouds);
  const bool on_meshes = any_mesh && config.dataset.meshes, on_scans = any_mesh && config.dataset.scans;

  const Source source{inputs, std::make_shared<Importer>(inputs.importer)};
  Output<Mesh> mesh;
  if (any_mesh) {
    const auto form = source.imports() ? add_import(table, kMeshes, source) : Output<ShapeInForm>();
    mesh = add_mesh(table, source, form);
    meshes.points = mesh;
    meshes.surface = mesh;
    meshes.on_faces = config.on_faces();
    if (config.recorded()) {
      meshes.ground_truth = add_gaze_truth(table, config, source, mesh, form);
    } else {
      meshes.ground_truth = add_mesh_ground_truth(table, config, source, mesh, form);
      if (meshes.on_faces)  // pictures show the ground truth of vertices all the same
        meshes.ground_truth = add_face_truth(table, source, mesh, form);
    }
    meshes.reference = add_reference(table, kMeshes, meshes.ground_truth, given_reference);
  }
  Output<Scan> scan;
  if (on_scans) {
    scan = table.add(kScans, stage(Role::shape, 1, "scan"), scan_of, prepared<ScanScene>(mesh), kPlace,
                     section("scan", config.scan));
    scans.points = scan;
    scans.ground_truth = table.add(kScans, stage(Role::ground_truth, 1, "scan_ground_truth"),
                                   scan_ground_truth, scan, mesh, meshes.ground_truth);
    scans.reference = add_reference(table, kScans, scans.ground_truth, given_reference);
  }

  if (on_meshes) {
    meshes.normals =
        table.add(kMeshes, stage(Role::normals, 1), mesh_normals, mesh, section("normals", config.normals));
    meshes.fpfh = add_fpfh(table, meshes, section("fpfh", config.fpfh));
  }
  if (on_scans) {
    scans.normals = table.add(kScans, stage(Role::normals, 1, "scan_normals"), scan_normals, scan,
                              section("scan_normals", config.scan_normals));
    scans.surface = table.add(kScans, stage(Role::surface, 1), partial_mesh, scan, scans.normals,
                              section("surface", config.surface));
    scans.fpfh = add_fpfh(table, scans, section<FpfhOptions>("scan_fpfh", config.scan_fpfh));
  }
  Output<PointCloud> cloud;
  if (any_cloud) cloud = add_cloud(table, config, source, given_reference, clouds);

  std::vector<ShapeOutputs*> evaluated;
  if (on_meshes) evaluated.push_back(&meshes);
  if (on_scans) evaluated.push_back(&scans);
  if (any_cloud) evaluated.push_back(&clouds);
  for (ShapeOutputs* shape : evaluated) {
    add_centre_densities(table, *shape, config);
    shape->names = {"name", [units = inputs.units](Unit unit) { return units.name(unit); }};
  }
  std::vector<Scored> scored;
  for (const Model& model : config.models) {
    if (model.human && on_meshes && !meshes.on_faces)  // people's picks are of vertices
      scored.push_back(
          {kMeshes, model.name, add_human_performance(table, meshes, mesh, inputs.units, config, model)});
    if (model.given) give_map_files(evaluated, inputs.units, model.given);
    for (ShapeOutputs* shape : evaluated)
      shape->originals = model.reads_originals ? originals_of(inputs, shape->level) : nullptr;
    for (const ShapeOutputs* shape : evaluated)
      if (!model.human)
        scored.push_back(
            {shape->level, model.name, add_model(table, *shape, config, with_smoothing.metrics, model)});
  }
  for (const ShapeOutputs* shape : evaluated)
    if (const auto constant = add_constant_scores(table, *shape, config); constant.rule())
      scored.push_back({shape->level, std::string(kConstantMap), constant});
  if (config.pictures != Pictures::none) {
    if (on_meshes) add_picture(table, config, kMeshes, picture_of_mesh, mesh);
    if (on_scans)
      add_picture(table, config, kScans, picture_of_scan, scan, scans.normals, scans.surface, mesh);
    if (any_cloud)
      add_picture(table, config, kClouds, picture_of_cloud, cloud, clouds.normals, clouds.surface);
  }
  add_score_tables(table, scored);
  return std::move(table).take();
}

Project make_project(const Config& config, const Inputs& inputs,
                     const std::optional<Histogram>& given_reference) {
  Attributes attributes = {{"protocol", std::string(name_of(config.protocol))}};
  if (config.simulated()) attributes.emplace_back("participants", std::string(kSimulatedNote));
  Project project{.rules = make_rules(config, inputs, given_reference),
                  .units = inputs.units,
                  .seed = config.seed,
                  .attributes = std::move(attributes),
                  .is_share = inputs.shard.has_value()};
  std::vector<std::size_t> references;
  for (std::size_t rule = 0; rule < project.rules.size(); ++rule)
    if (has_role(project.rules[rule], Role::reference)) references.push_back(rule);
  const std::vector<bool> read_by_them = project.ancestors(references);
  for (std::size_t rule = 0; rule < project.rules.size(); ++rule)
    project.rules[rule].for_all = read_by_them[rule] && !project.rules[rule].gathers;
  for (Rule& rule : project.rules)
    if (config.cached_alone &&
        std::ranges::none_of(kOfShapes, [&](Role role) { return has_role(rule, role); }))
      rule.only_if_cached = true;
  return project;
}

bool reference_is_given(const Rules& rules) {
  return std::ranges::any_of(rules, [](const Rule& rule) { return rule.given != nullptr; });
}

std::string node_name(const Rule& rule) {
  return fmt::format("{} of {}", rule.stage, shapes_name(rule.over));
}

std::string option_path(const Rule& rule, std::string_view key) {
  const std::string line = fmt::format("\n{}: ", key);
  for (const OptionLines& options : rule.options)
    if (("\n" + options.text).find(line) != std::string::npos)
      return fmt::format("{}.{}", options.section, key);
  return std::string(key);
}

}  // namespace salbench
