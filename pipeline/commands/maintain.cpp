// SPDX-License-Identifier: GPL-3.0-or-later
// Subcommands that look after a cache: verify and gc.
#include "pipeline/engine/maintain.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "cache/layout.h"
#include "io/table.h"
#include "pipeline/commands/cli.h"
#include "pipeline/commands/report.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

struct MaintainArguments : Arguments {
  std::vector<std::string> configs;  // may be empty where the command line names a cache
  bool deep = false;
  int sample = 20;     // jobs computed again, per configuration
  std::string stages;  // to be removed, and nothing else; separated by commas
  bool dry_run = false;
};

double megabytes(std::uint64_t bytes) { return static_cast<double>(bytes) / 1e6; }

// --- verify -----------------------------------------------------------------------------------------------

// Text goes out as soon as a check ends: the next one may take long, or find its cache unusable.
void say_faults(const Arguments& arguments, const std::vector<Fault>& faults, const std::string& summary) {
  if (arguments.format != "text") return;
  for (const Fault& fault : faults) fmt::print("{}: {}\n", fault.file.string(), fault.what);
  if (!arguments.quiet) fmt::print("{}", summary);
}

Json faults_json(const std::vector<Fault>& faults) {
  return list_of(faults, [](const Fault& fault) { return Json{{"file", fault.file}, {"what", fault.what}}; });
}

Json check_cache(const Arguments& arguments, const fs::path& cache) {
  Verification found;
  {
    const OrderlyEnd orderly;
    found = verify_cache(cache, interrupted(), *progress_of(arguments.quiet));
  }
  const auto& [artefacts, bytes, others, faults] = found;
  say_faults(
      arguments, faults,
      fmt::format("{}: {} artefacts, {:.1f} MB: {} bad{}{}\n", cache.string(), artefacts, megabytes(bytes),
                  faults.size(), faults.empty() ? "" : "; run again, which computes what was damaged, or gc",
                  others > 0 ? fmt::format("; {} other files, left alone", others) : ""));
  return {{"cache", cache},
          {"artefacts", artefacts},
          {"bytes", bytes},
          {"other_files", others},
          {"faults", faults_json(faults)}};
}

Json check_sample(const MaintainArguments& arguments, const Setup& setup) {
  FolderStore store(setup.cache, Access::read_only);
  const Plan plan = make_plan(setup.project, store);
  Recomputation found;
  {
    const OrderlyEnd orderly;
    found = recompute_sample(setup.project, plan, store, static_cast<std::size_t>(arguments.sample),
                             interrupted());
  }
  const auto& [jobs, faults] = found;
  say_faults(arguments, faults,
             fmt::format("{}: {} of its jobs computed again: {} came out otherwise\n", setup.config.name,
                         jobs, faults.size()));
  return {{"configuration", setup.config.name}, {"jobs", jobs}, {"faults", faults_json(faults)}};
}

ExitStatus run_verify(MaintainArguments arguments) {
  if (arguments.configs.empty() && arguments.cache.empty())
    throw ConfigError("name a configuration, or a cache with --cache DIR");
  Json caches = Json::array(), samples = Json::array();
  std::set<fs::path> seen;
  if (arguments.configs.empty()) caches.push_back(check_cache(arguments, arguments.cache));
  for (const std::string& config : arguments.configs) {
    arguments.config = config;
    const Setup setup(arguments, Pictures::cached);
    if (seen.insert(fs::weakly_canonical(setup.cache)).second)
      caches.push_back(check_cache(arguments, setup.cache));
    if (arguments.deep) samples.push_back(check_sample(arguments, setup));
  }
  const bool stopped = interrupted();
  print_report(arguments.format, "verify",
               {{"caches", caches}, {"samples", samples}, {"interrupted", stopped}}, "");
  if (stopped) return interrupted_status();
  const auto is_sound = [](const Json& checked) { return checked.at("faults").empty(); };
  return std::ranges::all_of(caches, is_sound) && std::ranges::all_of(samples, is_sound) ? kAllDone
                                                                                         : kSomeFailed;
}

// --- gc ---------------------------------------------------------------------------------------------------

Json amount_json(const Amount& amount) { return {{"files", amount.files}, {"bytes", amount.bytes}}; }

Json stage_json(const Collected::OfStage& stage) {
  return {{"stage", stage.stage}, {"kept", amount_json(stage.kept)}, {"removed", amount_json(stage.removed)}};
}

std::string collected_text(const Collected& collected, bool dry_run) {
  Table table{.columns = {"stage", "kept", "MB", dry_run ? "to remove" : "removed", "MB"}, .rows = {}};
  Amount all;
  for (const auto& [stage, kept, removed] : collected.stages) {
    table.rows.push_back({stage, cell_of(kept.files), megabytes(kept.bytes), cell_of(removed.files),
                          megabytes(removed.bytes)});
    all.files += removed.files;
    all.bytes += removed.bytes;
  }
  return fmt::format("{}\n{}: {} artefacts ({:.1f} MB), {} damaged files, {} unfinished files\n",
                     aligned(table, 1), dry_run ? "would be removed" : "removed", all.files,
                     megabytes(all.bytes), collected.damaged.files, collected.unfinished.files);
}

ExitStatus run_gc(MaintainArguments arguments) {
  const auto& configs = arguments.configs;
  const std::string& stages = arguments.stages;
  if (configs.empty() && (stages.empty() || arguments.cache.empty()))
    throw ConfigError("name the configurations to keep, or stages to remove with --stage, of a --cache DIR");
  KeepSet needed;
  std::size_t waiting = 0;  // jobs whose keys are not known yet
  fs::path folder = configs.empty() ? arguments.cache : "";
  for (const std::string& config : configs) {
    arguments.config = config;
    const Setup setup(arguments, Pictures::cached);
    if (!folder.empty() && fs::weakly_canonical(folder) != fs::weakly_canonical(setup.cache))
      throw ConfigError(fmt::format("{}: its cache is {}, not {}: clean one cache at a time", config,
                                    setup.cache.string(), folder.string()));
    folder = setup.cache;
    if (!stages.empty()) continue;
    const FolderStore store(folder, Access::read_only);
    waiting += add_needed(setup.project, make_plan(setup.project, store), needed);
  }
  if (!stages.empty()) {
    require_cache(folder);
    std::vector<std::string> known;
    for (const FolderStore::Usage& used : FolderStore(folder, Access::read_only).usage())
      known.push_back(used.stage);
    for (const std::string& stage : selected_stages(stages, known)) needed.drop(stage);
  }
  const Collected found = collect_garbage(folder, needed, arguments.dry_run, *progress_of(arguments.quiet));
  std::string text = collected_text(found, arguments.dry_run);
  if (waiting > 0)
    text += fmt::format("{} jobs wait for what they read: everything of their stages and items was kept\n",
                        waiting);
  print_report(arguments.format, "gc",
               {{"cache", folder},
                {"dry_run", arguments.dry_run},
                {"stages", list_of(found.stages, stage_json)},
                {"damaged", amount_json(found.damaged)},
                {"unfinished", amount_json(found.unfinished)},
                {"waiting", waiting}},
               arguments.quiet ? "" : text);
  return kAllDone;
}

CLI::Option* add_maintaining(CLI::App& app, MaintainArguments& arguments, const std::string& of_config) {
  add_data_set(app, arguments);
  app.add_flag("--quiet", arguments.quiet, "name what is wrong, and nothing else");
  return app.add_option("CONFIG", arguments.configs, of_config)->check(kPath);
}

}  // namespace

Action verify_subcommand(CLI::App& program) {
  const auto arguments = std::make_shared<MaintainArguments>();
  CLI::App& app = add_subcommand(
      program, "verify", "read every artefact of a cache and name each bad one",
      {{"verify configs/shrec07.yaml --data SchellingData --deep", "read all, and compute 20 jobs again"},
       {"verify --cache salbench-cache", "read every artefact of a cache"}});
  CLI::Option* config = add_maintaining(app, *arguments, "configuration files, or none with --cache");
  CLI::Option* deep =
      app.add_flag("--deep", arguments->deep, "also compute a sample of the cached jobs again, and compare");
  app.add_option("--sample", arguments->sample, "how many (default: 20)")
      ->check(CLI::Range(1, std::numeric_limits<int>::max()));
  add_format(app, *arguments);
  deep->needs(config);
  app.get_option("--data")->needs(config);
  for (const char* of_sample : {"--sample", "--items", "--split", "--reference"})
    app.get_option(of_sample)->needs(deep);
  return [arguments] { return run_verify(*arguments); };
}

Action gc_subcommand(CLI::App& program) {
  const auto arguments = std::make_shared<MaintainArguments>();
  CLI::App& app =
      add_subcommand(program, "gc", "remove from a cache what no run of these configurations needs",
                     {{"gc configs/shrec07.yaml --data SchellingData --dry-run", "what no run of it needs"},
                      {"gc --cache salbench-cache --stage map.LS", "all maps of a model"}});
  add_maintaining(app, *arguments, "every configuration whose artefacts are kept, or that names the cache");
  app.add_option("--stage", arguments->stages,
                 "remove all artefacts of these stages, and no others: map.LS,fpfh");
  app.add_flag("--dry-run", arguments->dry_run, "only say what would be removed");
  add_format(app, *arguments);
  return [arguments] { return run_gc(*arguments); };
}

}  // namespace salbench
