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

// --- functions that combine several stages ----------------------------------------------------------------

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

template <class Function, class... Arguments>
void add_picture(RuleTable& table, const Config& config, Level level, const Function& picture,
                 const Arguments&... arguments) {
  RuleHead head = stage(Role::picture, 2);
  head.only_if_cached = config.pictures == Pictures::cached;
  table.add(level, head, picture, arguments..., section("picture", config.picture), kRandom);
}

// Original files of each shape, including textures.
FilesOfUnits originals_of(const Inputs& inputs, Level level) {
  auto files = std::make_shared<std::vector<std::vector<File>>>(inputs.units.slots(level));
  if (inputs.shape_files)
    for (const Unit unit : inputs.units.of(level))
      (*files)[unit.index] = inputs.shape_files->at(inputs.units.family_of(unit));
  return files;
}

// Shapes and their pictures, from which everything else is computed.
constexpr std::array kOfShapes = {Role::import,    Role::shape,          Role::fixations,
                                  Role::gaze_hits, Role::visible_shares, Role::ground_truth,
                                  Role::normals,   Role::surface,        Role::picture};

void give_map_files(const std::vector<ShapeOutputs*>& shapes, const Units& units, const GivenMaps& maps) {
  std::vector<Level> levels;
  for (const ShapeOutputs* shape : shapes) levels.push_back(shape->level);
  const bool on_faces = std::ranges::any_of(shapes, &ShapeOutputs::on_faces);
  const auto files = map_files(maps, units, levels, on_faces);
  for (ShapeOutputs* shape : shapes) shape->map_files = files.at(shape->level);
}

// Table under construction: each group of rules reads outputs of earlier groups.
class GrowingTable {
 public:
  GrowingTable(const Config& with_smoothing, const Inputs& inputs, const std::optional<Histogram>& given,
               const Front& front)
      : config_(with_smoothing),
        smoothing_(with_smoothing.metrics),
        inputs_(inputs),
        given_(given),
        front_(front),
        source_{inputs, std::make_shared<const ItemReader>(front, inputs.read)} {
    config_.metrics.smoothing.clear();  // plain scores do not depend on it
    if (is_from_gaze(config_, inputs)) config_.dataset.participants = Participants::recorded;
  }

  Rules rules() && {
    const bool any_mesh = inputs_.has(kMeshes), any_cloud = inputs_.has(kClouds);
    const bool on_meshes = any_mesh && config_.dataset.meshes, on_scans = any_mesh && config_.dataset.scans;
    if (any_mesh) add_meshes();
    if (on_scans) add_scans();
    if (on_meshes) describe_meshes();
    if (on_scans) describe_scans();
    if (any_cloud) add_clouds();
    if (on_meshes) evaluated_.push_back(&meshes_);
    if (on_scans) evaluated_.push_back(&scans_);
    if (any_cloud) evaluated_.push_back(&clouds_);
    for (ShapeOutputs* shape : evaluated_) {
      add_centre_densities(table_, *shape, config_);
      shape->names = {"name", [units = inputs_.units](Unit unit) { return units.name(unit); }};
    }
    add_scores();
    if (config_.pictures != Pictures::none) add_pictures();
    add_score_tables(table_, scored_);
    return std::move(table_).take();
  }

 private:
  Output<ShapeInForm> add_form(Level level) {
    return source_.is_of_front() ? add_import(table_, level, source_) : Output<ShapeInForm>();
  }

  // Shapes and ground truth, from which scans are made.
  void add_meshes() {
    const Output<ShapeInForm> form = add_form(kMeshes);
    mesh_ = add_mesh(table_, source_, form);
    meshes_.points = mesh_;
    meshes_.surface = mesh_;
    meshes_.on_faces = config_.on_faces();
    if (config_.recorded()) {
      meshes_.ground_truth = add_gaze_truth(table_, config_, source_, mesh_, form);
    } else {
      meshes_.ground_truth = add_mesh_ground_truth(table_, config_, source_, mesh_, form);
      if (meshes_.on_faces)  // pictures always show the ground truth of vertices
        meshes_.ground_truth = add_face_truth(table_, source_, mesh_, form);
    }
    meshes_.reference = add_reference(table_, kMeshes, meshes_.ground_truth, given_);
  }

  void add_scans() {
    scan_ = table_.add(kScans, stage(Role::shape, 1, "scan"), scan_of, prepared<ScanScene>(mesh_), kPlace,
                       section("scan", config_.scan));
    scans_.points = scan_;
    scans_.ground_truth = table_.add(kScans, stage(Role::ground_truth, 1, "scan_ground_truth"),
                                     scan_ground_truth, scan_, mesh_, meshes_.ground_truth);
    scans_.reference = add_reference(table_, kScans, scans_.ground_truth, given_);
  }

  void describe_meshes() {
    meshes_.normals = table_.add(kMeshes, stage(Role::normals, 1), mesh_normals, mesh_,
                                 section("normals", config_.normals));
    meshes_.fpfh = add_fpfh(table_, meshes_, section("fpfh", config_.fpfh));
  }

  void describe_scans() {
    scans_.normals = table_.add(kScans, stage(Role::normals, 1, "scan_normals"), scan_normals, scan_,
                                section("scan_normals", config_.scan_normals));
    scans_.surface = table_.add(kScans, stage(Role::surface, 1), partial_mesh, scan_, scans_.normals,
                                section("surface", config_.surface));
    scans_.fpfh = add_fpfh(table_, scans_, section<FpfhOptions>("scan_fpfh", config_.scan_fpfh));
  }

  // A cloud's points are described like the vertices of a mesh: given equal normals, both have equal maps.
  // Stages that need faces use a partial mesh, as for scans.
  void add_clouds() {
    const Output<ShapeInForm> form = add_form(kClouds);
    cloud_ = add_points(table_, source_, form);
    clouds_.points = clouds_.cloud = cloud_;
    clouds_.normals = table_.add(kClouds, stage(Role::normals, 1, "cloud_normals"), cloud_normals, cloud_,
                                 section("scan_normals", config_.scan_normals));
    clouds_.surface = table_.add(kClouds, stage(Role::surface, 1), partial_mesh, cloud_, clouds_.normals,
                                 section("surface", config_.surface));
    clouds_.ground_truth = add_truth_of_clouds(form);
    clouds_.reference = add_reference(table_, kClouds, clouds_.ground_truth, given_);
    clouds_.fpfh = add_fpfh(table_, clouds_, section("fpfh", config_.fpfh));
  }

  Output<GroundTruth> add_truth_of_clouds(const Output<ShapeInForm>& form) {
    if (config_.on_faces()) return add_face_truth(table_, source_, cloud_);
    if (config_.recorded()) return add_gaze_truth(table_, config_, source_, cloud_, clouds_.surface, form);
    return add_cloud_ground_truth(table_, config_, source_, cloud_, clouds_.surface, form);
  }

  void add_scores() {
    for (const Model& model : config_.models) model.human ? add_people(model) : add_model_of_maps(model);
    for (const ShapeOutputs* shape : evaluated_)
      if (const auto constant = add_constant_scores(table_, *shape, config_); constant.rule())
        scored_.push_back({shape->level, std::string(kConstantMap), constant});
  }

  // Human performance needs scoring on vertices, which are what people picked.
  void add_people(const Model& model) {
    if (!inputs_.has(kMeshes) || !config_.dataset.meshes || meshes_.on_faces) return;
    scored_.push_back(
        {kMeshes, model.name, add_human_performance(table_, meshes_, mesh_, inputs_.units, config_, model)});
  }

  void add_model_of_maps(const Model& model) {
    if (model.given) give_map_files(evaluated_, inputs_.units, *model.given);
    const FunctionCall command = model.command ? model.command(front_) : FunctionCall();
    for (ShapeOutputs* shape : evaluated_) {
      shape->originals = model.reads_originals ? originals_of(inputs_, shape->level) : nullptr;
      shape->command = command;
      scored_.push_back({shape->level, model.name, add_model(table_, *shape, config_, smoothing_, model)});
    }
  }

  void add_pictures() {
    for (const ShapeOutputs* shape : evaluated_) {
      if (shape == &meshes_) add_picture(table_, config_, kMeshes, picture_of_mesh, mesh_);
      if (shape == &scans_)
        add_picture(table_, config_, kScans, picture_of_scan, scan_, scans_.normals, scans_.surface, mesh_);
      if (shape == &clouds_)
        add_picture(table_, config_, kClouds, picture_of_cloud, cloud_, clouds_.normals, clouds_.surface);
    }
  }

  Config config_;
  MetricsOptions smoothing_;  // with the steps after which smoothed maps are scored
  const Inputs& inputs_;
  const std::optional<Histogram>& given_;
  const Front& front_;
  Source source_;
  RuleTable table_;
  Output<Mesh> mesh_;
  Output<Scan> scan_;
  Output<PointCloud> cloud_;
  ShapeOutputs meshes_{.level = kMeshes}, scans_{.level = kScans}, clouds_{.level = kClouds};
  std::vector<ShapeOutputs*> evaluated_;
  std::vector<Scored> scored_;
};

}  // namespace

Rules make_rules(const Config& config, const Inputs& inputs, const std::optional<Histogram>& given_reference,
                 const Front& front) {
  return GrowingTable(config, inputs, given_reference, front).rules();
}

Project make_project(const Config& config, const Inputs& inputs,
                     const std::optional<Histogram>& given_reference, const Front& front) {
  Attributes attributes = {{"protocol", std::string(name_of(config.protocol))}};
  if (config.simulated()) attributes.emplace_back("participants", std::string(kSimulatedNote));
  Project project{.rules = make_rules(config, inputs, given_reference, front),
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

std::string node_name(const Rule& rule) {
  return fmt::format("{} of {}", rule.stage, shapes_name(rule.over));
}

}  // namespace salbench
