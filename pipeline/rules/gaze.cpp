// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/gaze.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "pipeline/inputs/loading.h"
#include "pipeline/rules/models.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr std::int32_t kFixationsVersion = 2, kHitsVersion = 2, kTruthVersion = 3, kVisibleVersion = 1;
constexpr std::int32_t kVisibleMassVersion = 4;  // for ground truths divided by visible mass

std::int32_t version_of(const GazeTruthOptions& options) {
  const bool by_mass = options.visible == GazeVisible::divided && options.weight == GazeWeight::mass;
  return by_mass ? kVisibleMassVersion : kTruthVersion;
}

const Mesh& mesh_of(const Mesh& mesh) { return mesh; }

GazeFixations fixations_in(const GazeRecording& recording, const Mesh& mesh, const std::string& item,
                           const FixationOptions& options) {
  if (recording.empty())
    throw InputError(fmt::format("{}: has no recording of gaze: import one, or leave the item out", item));
  return fixations_of(recording, mesh, options);
}

template <class... Shape>
Output<GazeFixations> add_fixations(RuleTable& table, Level level, const Config& config, const Source& source,
                                    const Output<ShapeInForm>& form, const Output<Shape>&... shape) {
  return table.add(
      level, stage(Role::fixations, kFixationsVersion),
      [reader = source.reader](const Shape&... of, const ShapeInForm* imported, const Files& files,
                               const FixationOptions& options) {
        const Mesh& mesh = mesh_of(of...);
        if (imported != nullptr) return fixations_in(imported->recording, mesh, files.name, options);
        const ShapeInForm read = reader->form(files, false).value_or(ShapeInForm());
        return fixations_in(read.recording, mesh, files.name, options);
      },
      shape..., form, source.files_read(), section("gaze", config.gaze.fixations));
}

// Shape: outputs from which a mesh is built.
template <class... Shape>
Output<GroundTruth> add_gaze_rules(RuleTable& table, Level level, std::string_view name, const Config& config,
                                   const Source& source, const Output<ShapeInForm>& form,
                                   const Output<Shape>&... shape) {
  const Output<GazeFixations> fixations = add_fixations(table, level, config, source, form, shape...);
  const Output<GazeHits> hits = table.add(
      level, stage(Role::gaze_hits, kHitsVersion),
      [](const Shape&... of, const GazeFixations& found, const GazeHitOptions& options, const UnitName& item,
         const Remark& remark) {
        const Mesh& mesh = mesh_of(of...);
        GazeHits all = hits_of(mesh, found, options);
        remark.text = remark_on_people(all, mesh);
        if (!remark.text.empty()) spdlog::warn("{}: {}", item.text, remark.text);
        return all;
      },
      shape..., fixations, section("gaze", config.gaze.hits), kName, kRemark);
  Output<VisibleShares> visible;
  if (config.gaze.truth.visible == GazeVisible::divided)
    visible = table.add(
        level, stage(Role::visible_shares, kVisibleVersion),
        [](const Shape&... of, const GazeFixations& found) { return visible_shares(mesh_of(of...), found); },
        shape..., fixations);
  const auto add_truth = [&](std::string_view stage_name, auto* truth) {
    return table.add(
        level, stage(Role::ground_truth, version_of(config.gaze.truth), stage_name),
        [truth](const Shape&... of, const GazeHits& found, const VisibleShares* seen,
                const GazeTruthOptions& options, const UnitName& item, const Remark& remark) {
          remark.text = remark_on_left_out(found.people, options.people);
          if (!remark.text.empty()) spdlog::warn("{}: {}", item.text, remark.text);
          return truth(mesh_of(of...), found, seen, options);
        },
        shape..., hits, visible, section("gaze", config.gaze.truth), kName, kRemark);
  };
  const Output<GroundTruth> of_vertices = add_truth(name, gaze_ground_truth);  // for pictures
  return config.on_faces() && level == kMeshes ? add_truth(kFaceTruth, gaze_face_truth) : of_vertices;
}

}  // namespace

bool is_from_gaze(const Config& config, const Inputs& inputs) {
  if (config.simulated()) return false;
  if (config.recorded() && inputs.recordings == Recordings::none && !inputs.units.families().empty())
    throw ConfigError("dataset: {participants: recorded}: no item of the data set has a recording of gaze");
  return config.recorded() || inputs.recordings == Recordings::alone;
}

std::string gaze_recipe(const GazeOptions& options) {
  const auto stage_text = []<class Options>(std::int32_t version, const Options& of_stage) {
    YamlFields fields = {{"version", version}};
    Options::fields(of_stage, [&](std::string_view key, const auto& value, const OptionHelp&) {
      fields.emplace_back(key, option_text(value));
    });
    return yaml_mapping(fields);
  };
  const bool divided = options.truth.visible == GazeVisible::divided;
  return yaml_mapping(
      {{name_of(Role::fixations), stage_text(kFixationsVersion, options.fixations)},
       {name_of(Role::gaze_hits), stage_text(kHitsVersion, options.hits)},
       {name_of(Role::visible_shares), divided ? stage_text(kVisibleVersion, NoOptions()) : ""},
       {name_of(Role::ground_truth), stage_text(version_of(options.truth), options.truth)}});
}

Output<GroundTruth> add_gaze_truth(RuleTable& table, const Config& config, const Source& source,
                                   const Output<Mesh>& mesh, const Output<ShapeInForm>& form) {
  return add_gaze_rules(table, kMeshes, "ground_truth", config, source, form, mesh);
}

Output<GroundTruth> add_gaze_truth(RuleTable& table, const Config& config, const Source& source,
                                   const Output<PointCloud>& cloud, const Output<Surface>& surface,
                                   const Output<ShapeInForm>& form) {
  return add_gaze_rules(table, kClouds, "cloud_ground_truth", config, source, form, cloud, surface);
}

}  // namespace salbench
