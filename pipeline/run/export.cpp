// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run/export.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "cache/artefact.h"
#include "io/file.h"
#include "io/hdf5/hdf5_file.h"
#include "io/shapes/shape_file.h"
#include "pipeline/config/option_text.h"
#include "pipeline/results/counts.h"
#include "pipeline/rules/shapes.h"
#include "pipeline/run/export_file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

// All but the score tables, which are exported with the scores.
std::vector<std::string> stages_of(const Rules& rules) {
  std::vector<std::string> names;
  for (const std::vector<std::size_t>& of_stage : rules_by_stage(rules))
    if (const Rule& rule = rules[of_stage[0]]; !has_role(rule, Role::score_table))
      names.push_back(rule.stage);
  return names;
}

// Stages shown in a report.
std::vector<std::string> shown_stages(const Rules& rules) {
  constexpr std::array kShown = {Role::shape, Role::gaze_hits, Role::ground_truth, Role::normals,
                                 Role::map,   Role::matched,   Role::picture};
  std::vector<std::string> names;
  for (const Rule& rule : rules)
    if (std::ranges::any_of(kShown, [&](Role role) { return has_role(rule, role); }))
      names.push_back(rule.stage);
  return names;
}

// Sum of what `write` returns per shape. Ends early at a signal.
template <class Write>
std::size_t write_each(Session& session, const char* what, const Write& write) {
  const std::vector<Unit> shapes = session.state().shapes();
  std::size_t written = 0;
  session.progress->begin(what, shapes.size());
  for (const Unit shape : shapes) {
    if (session.stop) break;
    written += write(session.state(), shape);
    session.progress->item_done();
  }
  session.progress->end();
  return written;
}

// --- shapes -----------------------------------------------------------------------------------------------

// Adds a stage's value to a shape if it is per point; others, such as scores of faces, are skipped. The value
// must outlive the shape.
void add_part(ShapeWithFields& shape, const std::string& stage, const std::any& value) {
  if (const auto* mesh = value_if<Mesh>(value)) {
    shape.points = mesh->vertices;
    shape.faces = mesh->faces;
  }
  if (const auto* scan = value_if<Scan>(value)) shape.points = scan->points;
  if (const auto* cloud = value_if<PointCloud>(value)) shape.points = cloud->points;
  if (const auto* normals = value_if<Normals>(value)) shape.normals = *normals;
  if (const auto* faces = value_if<Faces>(value)) shape.faces = *faces;
  const std::size_t n = shape.points.size();
  if (const auto* field = value_if<ScalarField>(value); field != nullptr && field->size() == n)
    shape.fields.push_back({item_label(stage), *field});
  if (const auto* truth = value_if<GroundTruth>(value); truth != nullptr && stage != kFaceTruth) {
    if (!truth->saliency.empty()) shape.fields.push_back({"ground_truth", truth->saliency});
    ScalarField picks(n);
    for (const auto& participant : truth->picks)
      for (const std::int32_t point : participant) ++picks[static_cast<std::size_t>(point)];
    shape.fields.push_back({"picks", std::move(picks)});
  }
}

// Rules are in dependency order: the points come first.
ShapeWithFields shape_of(const RunState& run, Unit unit, const StageNames& stages,
                         std::vector<ValuePtr>& values) {
  ShapeWithFields shape;
  if (run.config.simulated()) shape.remark = kSimulatedNote;
  for (const Job& job : run.project().jobs_of(unit)) {
    const Rule& rule = run.project().rule(job);
    if (!run.decision(job).known() || (!has_role(rule, Role::shape) && !stages.contains(rule.stage)))
      continue;
    values.push_back(run.resolver.value(job));
    add_part(shape, rule.stage, *values.back());
  }
  return shape;
}

std::size_t write_shapes(Session& session, const StageNames& stages, const fs::path& folder) {
  make_folder(folder, "choose another with --to");
  return write_each(session, "exporting", [&](const RunState& run, Unit unit) -> std::size_t {
    std::vector<ValuePtr> values;  // spans refer to them
    const ShapeWithFields shape = shape_of(run, unit, stages, values);
    if (shape.points.empty()) return 0;
    write_file(folder / (run.units().name(unit) + ".ply"), ply_of(shape));
    return 1;
  });
}

// --- maps -------------------------------------------------------------------------------------------------

// Role of the written maps: as computed, or matched if --stage requests it.
Role role_of_maps(const std::string& stages) {
  if (stages.empty() || stages == "map") return Role::map;
  if (stages == "matched") return Role::matched;
  throw ConfigError(fmt::format("--stage {}: with --format maps it must be map or matched", stages));
}

// Writes TO/MODEL/ITEM.val for every known map, one value per line.
std::size_t write_maps(Session& session, const fs::path& folder, Role role) {
  for (const Model& model : session.setup.config.models)
    if (model.add_map) make_folder(folder / model.name, "choose another with --to");
  return write_each(session, "writing", [&](const RunState& run, Unit shape) {
    std::size_t written = 0;
    for (const Job& job : run.project().jobs_of(shape)) {
      const Rule& rule = run.project().rule(job);
      if (!has_role(rule, role) || !run.decision(job).known()) continue;
      std::string lines;
      const ValuePtr map = run.resolver.value(job);
      for (const double value : value_as<ScalarField>(*map)) lines += fmt::format("{}\n", value);
      write_file(folder / rule.subject / (run.units().name(shape) + ".val"), lines);
      ++written;
    }
    return written;
  });
}

// Throws ConfigError if the export would overwrite the user's files: input shapes or maps, or a file that is
// not HDF5.
void require_free(const fs::path& to, ExportForm form, const Setup& setup) {
  const bool one_file = form == ExportForm::h5, maps = form == ExportForm::maps;
  const auto refuse = [&](const std::string& wrong) {
    throw ConfigError(fmt::format("--to {}: {}; choose another", to.string(), wrong));
  };
  std::error_code none;
  for (const Model& model : setup.config.models)
    if (model.given && fs::equivalent(maps ? to / model.name : to, model.given->source, none))
      refuse(fmt::format("the maps of {} are read from there", model.name));
  if (maps) return;
  for (const Family& family : setup.inputs.units.families()) {
    const Item& item = item_of(family.source);
    if (fs::equivalent(one_file ? to : to / (item.name + ".ply"), item.file, none))
      refuse(fmt::format("{} is read from there", item.name));
  }
  if (one_file && fs::is_regular_file(to, none) && fs::file_size(to, none) > 0 && !is_hdf5(to))
    refuse("is there, and no HDF5 file");
}

StageNames stages_to_write(const ExportOptions& options, const Rules& rules) {
  const std::vector<std::string> selected =
      selected_stages(options.stages, options.for_report ? shown_stages(rules) : stages_of(rules));
  return {selected.begin(), selected.end()};
}

}  // namespace

Request request_of_export(Request request, const ExportOptions& options) {
  const bool one_file = options.form == ExportForm::h5;
  if (!one_file && (options.link || options.for_report || request.pictures != Pictures::none))
    throw ConfigError(fmt::format("--{}: only one HDF5 file (--format h5) can hold {}",
                                  options.link ? "link" : "pictures", options.link ? "links" : "them"));
  if (options.form == ExportForm::maps) role_of_maps(options.stages);
  if (one_file) request.pictures = std::max(request.pictures, Pictures::cached);
  if (options.for_report) request.pictures = Pictures::computed;
  request.cached_alone = options.for_report;
  return request;
}

std::size_t export_run(Session& session, const ExportOptions& options, int threads) {
  require_free(options.to, options.form, session.setup);
  const bool maps = options.form == ExportForm::maps;
  const StageNames stages = maps ? StageNames() : stages_to_write(options, session.setup.project.rules);
  session.compute(threads);
  if (session.stop) return 0;
  require_distinct_names(session.state());
  if (maps) return write_maps(session, options.to, role_of_maps(options.stages));
  if (options.form == ExportForm::ply) return write_shapes(session, stages, options.to);
  export_file(session, stages, options.to, options.link);
  return session.state().shapes().size();
}

}  // namespace salbench
