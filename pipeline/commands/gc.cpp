// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include <fmt/format.h>

#include "io/table.h"
#include "pipeline/commands/report.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/stage_names.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/engine/maintain.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

struct GcOptions {
  std::vector<std::string> configs;  // may be empty where stages and a cache are named
  std::string stages;                // to be removed, and nothing else; separated by commas
  bool dry_run = false;
};

struct GcReport {
  fs::path cache;
  bool dry_run = false;
  Collected collected;
  std::size_t waiting = 0;  // jobs whose keys are not known yet
};

Json json_of(const Amount& amount) { return {{"files", amount.files}, {"bytes", amount.bytes}}; }

Json json_of(const GcReport& report) {
  const Collected& collected = report.collected;
  return {{"cache", report.cache},
          {"dry_run", report.dry_run},
          {"stages", list_of(collected.stages,
                             [](const Collected::OfStage& stage) {
                               return Json{{"stage", stage.stage},
                                           {"kept", json_of(stage.kept)},
                                           {"removed", json_of(stage.removed)}};
                             })},
          {"damaged", json_of(collected.damaged)},
          {"unfinished", json_of(collected.unfinished)},
          {"waiting", report.waiting}};
}

double megabytes(std::uint64_t bytes) { return static_cast<double>(bytes) / 1e6; }

std::string text_of(const GcReport& report) {
  const auto& [cache, dry_run, collected, waiting] = report;
  Table table{.columns = {"stage", "kept", "MB", dry_run ? "to remove" : "removed", "MB"}, .rows = {}};
  Amount removed;
  for (const Collected::OfStage& stage : collected.stages) {
    table.rows.push_back({stage.stage, cell_of(stage.kept.files), megabytes(stage.kept.bytes),
                          cell_of(stage.removed.files), megabytes(stage.removed.bytes)});
    removed.files += stage.removed.files;
    removed.bytes += stage.removed.bytes;
  }
  std::string text =
      fmt::format("{}\n{}: {} artefacts ({:.1f} MB), {} damaged ones, {} unfinished files\n",
                  aligned(table, 1), dry_run ? "would be removed" : "removed", removed.files,
                  megabytes(removed.bytes), collected.damaged.files, collected.unfinished.files);
  if (waiting > 0)
    text += fmt::format("{} jobs wait for what they read: everything of their stages and items was kept\n",
                        waiting);
  return text;
}

ExitStatus run_gc(Arguments arguments, const GcOptions& options, ReportFormat format) {
  if (options.configs.empty() && (options.stages.empty() || arguments.cache.empty()))
    throw ConfigError("name the configurations to keep, or stages to remove with --stage, of a --cache DIR");
  KeepSet needed;
  GcReport report{.cache = {}, .dry_run = options.dry_run, .collected = {}};
  fs::path& folder = report.cache;
  folder = options.configs.empty() ? arguments.cache : "";
  for (const std::string& config : options.configs) {
    arguments.config = config;
    const Setup setup(arguments, {}, Pictures::cached);
    if (!folder.empty() && fs::weakly_canonical(folder) != fs::weakly_canonical(setup.cache))
      throw ConfigError(fmt::format("{}: its cache is {}, not {}: clean one cache at a time", config,
                                    setup.cache.string(), folder.string()));
    folder = setup.cache;
    if (!options.stages.empty()) continue;
    const FolderStore store(folder, Access::read_only);
    report.waiting += add_needed(setup.project, make_plan(setup.project, store), needed);
  }
  if (!options.stages.empty()) {
    std::vector<std::string> known;
    for (const FolderStore::Usage& used : FolderStore(folder, Access::read_only).usage())
      known.push_back(used.stage);
    for (const std::string& stage : selected_stages(options.stages, known)) needed.drop(stage);
  }
  report.collected = collect_garbage(folder, needed, options.dry_run, *progress_of(arguments.quiet));
  print_report(format, "gc", json_of(report), arguments.quiet ? "" : text_of(report));
  return kAllDone;
}

}  // namespace

Subcommand gc_subcommand(Arguments& arguments) {
  const auto options = std::make_shared<GcOptions>();
  const FormatWord format = default_format();
  return {"gc", "remove from a cache what no run of these configurations needs",
          maintaining_parameters(
              arguments, {of_path({"CONFIG", &options->configs,
                                   "every configuration whose artefacts are kept, or that names the cache"}),
                          {"--stage", &options->stages,
                           "remove all artefacts of these stages, and no others: map.LS,fpfh"},
                          {"--dry-run", &options->dry_run, "only say what would be removed"},
                          format_parameter(format)}),
          [&arguments, options, format](const std::atomic<bool>&) {
            return run_gc(arguments, *options, format_of(format));
          }};
}

}  // namespace salbench
