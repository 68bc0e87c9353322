// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/models.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "io/shapes/text_scanner.h"
#include "io/table.h"
#include "stages/models/cs.h"
#include "stages/models/floors.h"
#include "stages/models/lce.h"
#include "stages/models/ls.h"
#include "stages/models/lvj.h"
#include "stages/models/ms.h"
#include "stages/models/ps.h"
#include "stages/models/vis.h"

namespace salbench {
namespace {

// Names with another meaning in tables, in the cache or in a configuration.
constexpr std::array<std::string_view, 5> kTaken = {"GS", "Avg", kConstantMap, kRemarks, kFloors};
constexpr std::size_t kLongestName = 40;

char lower_case(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

ModelRow human_row(std::string_view name, std::int32_t version, const ModelAbout& about) {
  return {name, about, [=](const std::string& called, std::span<const Section> written, Protocol protocol) {
            const auto options = options_in<HsOptions>(written, protocol);
            return Model{.name = called,
                         .version = version,
                         .options = options_text(options),
                         .annotated_options = options_text(options, true),
                         .option_rows = option_rows(options),
                         .human = options};
          }};
}

ModelAbout about_model(std::string_view name) {
  const auto row = std::ranges::find(model_rows(), name, &ModelRow::name);
  if (row != model_rows().end()) return row->about;
  return name == kConstantMap ? kConstantAbout : ModelAbout();
}

}  // namespace

std::span<const ModelRow> model_rows() {
  static const std::array rows = {
      model_row("LS", 5, kLsAbout, ls_saliency),
      model_row("CS", 3, kCsAbout, cs_saliency),
      model_row("PS", 1, kPsAbout, ps_saliency),
      model_row("MS", 1, kMsAbout, ms_saliency),
      human_row("HS", 1, kHsAbout),
      model_row("RS", 1, kRsAbout, rs_saliency),
      // Not in the paper.
      model_row("MC", 1, kMcAbout, mc_saliency),
      model_row("LVJ", 1, kLvjAbout, lvj_saliency),
      model_row("LCE", 1, kLceAbout, lce_saliency),
      model_row("CB", 1, kCbAbout, cb_saliency),
      model_row("VIS", 1, kVisAbout, vis_saliency),
      model_row("NV", 1, kNvAbout, nv_saliency),
      model_row("VD", 1, kVdAbout, vd_saliency),
      model_row("SD", 1, kSdAbout, sd_saliency, sd_saliency_of_points),
  };
  return rows;
}

bool is_built_in_model(std::string_view name) {
  return std::ranges::find(model_rows(), name, &ModelRow::name) != model_rows().end();
}

bool is_reference_model(std::string_view name) { return about_model(name).is_reference; }

bool is_floor_model(std::string_view name) { return about_model(name).is_floor; }

std::string wrong_with_model_name(std::string_view name) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  };
  if (name.empty() || name.size() > kLongestName || !std::ranges::all_of(name, plain))
    return fmt::format("must be 1 to {} letters, digits, '-' and '_'", kLongestName);
  const auto is_this = [&](std::string_view taken) {
    return std::ranges::equal(taken, name, {}, lower_case, lower_case);
  };
  if (std::ranges::any_of(kTaken, is_this) || std::ranges::any_of(model_rows(), is_this, &ModelRow::name))
    return "is the name of something else in the tables, whatever its capitals; choose another";
  return {};
}

// Only the number of points is used.
Model given_model(const std::string& name, GivenMaps given) {
  if (const std::string wrong = wrong_with_model_name(name); !wrong.empty())
    throw ConfigError(fmt::format("--name {}: {}", in_quotes(name), wrong));
  const auto maps = std::make_shared<const GivenMaps>(std::move(given));
  const auto of_cloud = [maps](const PointCloud& cloud, const Files& file) {
    return maps->checked(file.data[0], file.name, cloud.points.size(), 0, &cloud);
  };
  const auto of_shape = [maps](Points points, Surface mapped_faces, const Files& file) {
    return maps->checked(file.data[0], file.name, points.size(), mapped_faces.size());
  };
  const auto add_map = [=](RuleTable& table, const ShapeOutputs& shape) {
    const RuleHead head = stage_of(name, maps->matched ? Role::matched : Role::map, 1);
    const auto files = files_of(shape.map_files, false);
    return shape.level == kClouds
               ? table.add(shape.level, head, of_cloud, shape.cloud, files)
               : table.add(shape.level, head, of_shape, shape.points, shape.mapped_faces(), files);
  };
  return {.name = name, .version = 1, .add_map = add_map, .given = maps};
}

}  // namespace salbench
