// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/gaze.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "pipeline/inputs/loading.h"
#include "pipeline/rules/models.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr std::int32_t kFixationsVersion = 1, kHitsVersion = 1, kTruthVersion = 2, kVisibleVersion = 1;

const Mesh& mesh_of(const Mesh& mesh) { return mesh; }

GazeFixations fixations_in(const ShapeInForm& form, const std::string& item, const FixationOptions& options) {
  if (form.recording.empty())
    throw InputError(fmt::format("{}: has no recording of gaze: import one, or leave the item out", item));
  return fixations_of(form.recording, options);
}

Output<GazeFixations> add_fixations(RuleTable& table, Level level, const Config& config, const Source& source,
                                    const Output<ShapeInForm>& form) {
  const RuleHead head = stage(Role::fixations, kFixationsVersion);
  const auto options = section("gaze", config.gaze.fixations);
  if (source.is_of_front())
    return table.add(
        level, head,
        [](const ShapeInForm& shape, const UnitName& name, const FixationOptions& chosen) {
          return fixations_in(shape, name.text, chosen);
        },
        form, kName, options);
  return table.add(
      level, head,
      [reader = source.reader](const Files& files, const FixationOptions& chosen) {
        return fixations_in(reader->form(files, false).value_or(ShapeInForm()), files.name, chosen);
      },
      files_of(source.inputs.shape_files), options);
}

// Shape: what makes a mesh.
template <class... Shape>
Output<GroundTruth> add_gaze_rules(RuleTable& table, Level level, std::string_view name, const Config& config,
                                   const Source& source, const Output<ShapeInForm>& form,
                                   const Output<Shape>&... shape) {
  const Output<GazeFixations> fixations = add_fixations(table, level, config, source, form);
  const Output<GazeHits> hits = table.add(
      level, stage(Role::gaze_hits, kHitsVersion),
      [](const Shape&... of, const GazeFixations& found, const GazeHitOptions& options, const UnitName& item,
         const Remark& remark) {
        GazeHits all = hits_of(mesh_of(of...), found, options);
        remark.text = remark_on_people(all);
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
        level, stage(Role::ground_truth, kTruthVersion, stage_name),
        [truth](const Shape&... of, const GazeHits& found, const VisibleShares* seen,
                const GazeTruthOptions& options) { return truth(mesh_of(of...), found, seen, options); },
        shape..., hits, visible, section("gaze", config.gaze.truth));
  };
  const Output<GroundTruth> of_vertices = add_truth(name, gaze_ground_truth);  // which pictures show
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
  const auto part = [](Role stage, std::int32_t version, const std::string& lines) {
    std::string text = fmt::format("{}: {{version: {}", name_of(stage), version);
    for (std::size_t begin = 0, end = 0; (end = lines.find('\n', begin)) != std::string::npos;
         begin = end + 1)
      text += ", " + lines.substr(begin, end - begin);
    return text + "}";
  };
  std::string text =
      fmt::format("{{{}, {}", part(Role::fixations, kFixationsVersion, options_text(options.fixations)),
                  part(Role::gaze_hits, kHitsVersion, options_text(options.hits)));
  if (options.truth.visible == GazeVisible::divided)
    text += ", " + part(Role::visible_shares, kVisibleVersion, "");
  return fmt::format("{}, {}}}", text, part(Role::ground_truth, kTruthVersion, options_text(options.truth)));
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
