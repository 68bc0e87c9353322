// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string_view>

#include <fmt/format.h>

#include "cache/artefact.h"
#include "io/file.h"
#include "io/hdf5/hdf5_file.h"
#include "io/shapes/shape_file.h"
#include "pipeline/commands/interrupt.h"
#include "pipeline/commands/run.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/stage_names.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/config/option_text.h"
#include "pipeline/results/export_file.h"
#include "pipeline/rules/shapes.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

struct ExportOptions {
  std::string stages;  // "scan,fpfh,map": stages, or what stands before the point in theirs; empty: all
  std::string format = "h5";  // one HDF5 file; the name of a ShapeFormat: a folder of shapes; or kMaps
  bool link = false;          // h5: refer to the artefacts in the cache, do not copy them
  bool pictures = false;      // h5: compute those that the cache lacks
  FormatWord summary = default_format();
};

constexpr std::string_view kMaps = "maps";  // TO/MODEL/ITEM.val, one value per line

// All but the tables of scores, which are exported with the scores.
std::vector<std::string> stages_of(const Rules& rules) {
  std::vector<std::string> names;
  for (const Rule& rule : rules)
    if (!has_role(rule, Role::score_table) && std::ranges::find(names, rule.stage) == names.end())
      names.push_back(rule.stage);
  return names;
}

// --- shapes -----------------------------------------------------------------------------------------------

// Gives a shape the part of it that a stage's value holds; other values are not per point, such as those of
// faces that are scored. The value must outlive the shape.
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

// Rules stand in the order of their inputs: the points come first.
bool write_shape(Session& session, Unit unit, ShapeFormat format, const StageNames& stages,
                 const fs::path& folder) {
  const RunState run = session.state();
  ShapeWithFields shape;
  if (session.setup.config.simulated()) shape.remark = kSimulatedNote;
  std::vector<ValuePtr> values;  // spans refer to them
  for (const Job& job : run.project().jobs_of(unit)) {
    const Rule& rule = run.project().rule(job);
    if (!run.decision(job).known() || (!has_role(rule, Role::shape) && !stages.contains(rule.stage)))
      continue;
    values.push_back(run.resolver.value(job));
    add_part(shape, rule.stage, *values.back());
  }
  if (shape.points.empty()) return false;
  write_file(folder / fmt::format("{}.{}", run.units().name(unit), name_of(format)),
             shape_text(shape, format));
  return true;
}

std::size_t write_shapes(Session& session, ShapeFormat format, const StageNames& stages,
                         const fs::path& folder, const std::atomic<bool>& stop) {
  make_folder(folder, "choose another with --to");
  const std::vector<Unit> shapes = session.state().shapes();
  std::size_t written = 0;
  session.progress->begin("exporting", shapes.size());
  for (const Unit shape : shapes) {
    if (stop) break;
    written += write_shape(session, shape, format, stages, folder) ? 1U : 0U;
    session.progress->item_done();
  }
  session.progress->end();
  return written;
}

// --- maps -------------------------------------------------------------------------------------------------

std::string val_text(const ScalarField& field) {
  std::string lines;
  for (const double value : field) lines += fmt::format("{}\n", value);
  return lines;
}

// The role of the maps that are written: as models compute them, or matched where --stage says so.
Role role_of_maps(const std::string& stages) {
  if (stages.empty() || stages == "map") return Role::map;
  if (stages == "matched") return Role::matched;
  throw ConfigError(fmt::format("--stage {}: with --format maps it must be map or matched", stages));
}

// Writes TO/MODEL/ITEM.val for every map that is known; returns how many. Ends early once `stop` is set.
std::size_t write_maps(Session& session, const fs::path& folder, Role role, const std::atomic<bool>& stop) {
  const RunState run = session.state();
  for (const Model& model : session.setup.config.models)
    if (model.add_map) make_folder(folder / model.name, "choose another with --to");
  const std::vector<Unit> shapes = run.shapes();
  std::size_t written = 0;
  session.progress->begin("writing", shapes.size());
  for (const Unit shape : shapes) {
    for (const Job& job : run.project().jobs_of(shape)) {
      if (stop) return written;
      const Rule& rule = run.project().rule(job);
      if (!has_role(rule, role) || !run.decision(job).known()) continue;
      const ValuePtr map = run.resolver.value(job);
      write_file(folder / rule.subject / (run.units().name(shape) + ".val"),
                 val_text(value_as<ScalarField>(*map)));
      ++written;
    }
    session.progress->item_done();
  }
  session.progress->end();
  return written;
}

// Throws ConfigError where the export would take the place of what is the user's: of a file that is no HDF5,
// or of one that a shape is read from. extension: of a shape's file; empty for one HDF5 file.
void require_free(const fs::path& to, const std::string& extension, const Inputs& inputs) {
  std::error_code none;
  const bool one_file = extension.empty();
  if (one_file && fs::is_regular_file(to, none) && fs::file_size(to, none) > 0 && !is_hdf5(to))
    throw ConfigError(fmt::format("--to {}: is there, and no HDF5 file; choose another", to.string()));
  for (const Family& family : inputs.units.families()) {
    const DatasetItem& item = item_of(family.source);
    if (fs::equivalent(one_file ? to : to / (item.name + extension), item.mesh, none))
      throw ConfigError(
          fmt::format("--to {}: {} is read from there; choose another", to.string(), item.name));
  }
}

ExitStatus run_export(const Arguments& arguments, const ExportOptions& options,
                      const std::atomic<bool>& stop) {
  const ReportFormat summary = format_of(options.summary, false, "--summary");
  const bool one_file = options.format == "h5", maps = options.format == kMaps;
  const Role role = maps ? role_of_maps(options.stages) : Role::shape;
  ShapeFormat format{};
  if (!one_file && !maps && !parse_option(options.format, format))
    throw ConfigError(
        fmt::format("--format {}: must be h5, {} or {}", options.format, kMaps, expected_of<ShapeFormat>()));
  if (!one_file && (options.link || options.pictures))
    throw ConfigError(fmt::format("--{}: only one HDF5 file (--format h5) can hold {}",
                                  options.link ? "link" : "pictures", options.link ? "links" : "them"));

  Session session(arguments, stop, {},
                  options.pictures ? Pictures::computed
                  : one_file       ? Pictures::cached
                                   : Pictures::none);
  if (!maps) require_free(arguments.to, one_file ? "" : "." + options.format, session.setup.inputs);
  const StageNames stages =
      maps ? StageNames() : selected_stages(options.stages, stages_of(session.setup.project.rules));
  const OrderlyEnd orderly;
  session.run(thread_count(arguments));
  if (stop) return interrupted_status(arguments);

  std::string done = fmt::format("exported to {}\n", arguments.to);
  std::size_t written = session.state().shapes().size();
  if (one_file) {
    if (!export_file({session.state(), session.store, *session.progress, session.setup.cache}, stages,
                     arguments.to, options.link, stop))
      return interrupted_status(arguments);
  } else {
    written = maps ? write_maps(session, arguments.to, role, stop)
                   : write_shapes(session, format, stages, arguments.to, stop);
    if (stop) return interrupted_status(arguments);
    done = fmt::format("{} {} written to {}\n", written, maps ? "maps" : "shapes", arguments.to);
  }
  Json document = {{"to", arguments.to}, {"format", options.format}, {"shapes", written}};
  document.update(summary_of(session));
  print_report(summary, "export", document, arguments.quiet ? "" : done);
  return finished_status(session);
}

}  // namespace

Subcommand export_subcommand(Arguments& arguments) {
  const auto options = std::make_shared<ExportOptions>();
  return {
      "export",
      "write what is known of some items to one HDF5 file, to shapes for viewers, or the maps alone",
      running_parameters(
          arguments,
          {{"--stage", &options->stages,
            "only these stages, such as scan,fpfh,map.LS; map stands for all of map.*"},
           {"--models", &arguments.models, "only these, such as LS,PS"},
           of_path({"--to", &arguments.to, "the HDF5 file, or the folder of the shapes or maps", true}),
           {"--format", &options->format,
            "h5 (default); one shape per item: csv, ply, vtp; or maps: TO/MODEL/ITEM.val, one value "
            "per line, after histogram matching with --stage matched"},
           {"--link", &options->link, "refer to the artefacts in the cache, do not copy them"},
           {"--pictures", &options->pictures,
            "compute the pictures that the cache lacks, for reports that show shapes"},
           {"--summary", options->summary.get(),
            "text (default), or json: what was done, for programs (docs/json.md)"}}),
      [&arguments, options](const std::atomic<bool>& stop) { return run_export(arguments, *options, stop); }};
}

}  // namespace salbench
