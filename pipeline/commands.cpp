#include "pipeline/commands.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <thread>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "cache/folder_store.h"
#include "io/table.h"
#include "io/text_file.h"
#include "pipeline/config.h"
#include "pipeline/plan.h"
#include "pipeline/results.h"
#include "pipeline/runner.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

// Everything that stands before the first job. The context refers to its neighbours, so it is never moved.
struct Setup {
  Config config;
  Catalog catalog;
  Workload workload;
  Context context;
  fs::path cache, output;

  Setup(Config c, Workload w, const Arguments& arguments)
      : config(std::move(c)),
        catalog(make_catalog(config)),
        workload(std::move(w)),
        context{catalog, workload, config.seed} {
    cache = !arguments.cache.empty() ? arguments.cache
            : !config.cache.empty()  ? config.cache
                                     : "salbench-cache";
    output = !arguments.output.empty() ? fs::path(arguments.output)
             : !config.output.empty()  ? fs::path(config.output)
                                       : fs::path("salbench-out") / config.name;
    if (!arguments.reference.empty()) context.given_reference = read_reference(arguments.reference);
    context.attributes = {{"protocol", std::string(name_of(config.protocol))}};
    if (config.simulated()) context.attributes.emplace_back("participants", std::string(kSimulatedNote));
  }
  Setup(const Setup&) = delete;
  Setup& operator=(const Setup&) = delete;
};

// Keeps the models that `--models` names.
void select_models(Config& config, const std::string& list) {
  std::vector<std::string_view> known;
  for (const Model& model : config.models) known.push_back(model.name);
  const std::vector<std::string> wanted = split_list(list);
  for (const std::string& name : wanted) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw ConfigError(fmt::format("--models {}: the configuration has no model '{}'; it has {}", list, name,
                                  fmt::join(known, ", ")));
  }
  if (!wanted.empty())
    std::erase_if(config.models, [&](const Model& model) {
      return std::find(wanted.begin(), wanted.end(), model.name) == wanted.end();
    });
}

std::unique_ptr<Setup> set_up(const Arguments& arguments) {
  Config config =
      read_config(Section::from_file(arguments.config), fs::path(arguments.config).stem().string());
  select_models(config, arguments.models);
  const std::string data = arguments.data.empty() ? config.data : arguments.data;
  if (data.empty())
    throw ConfigError(
        fmt::format("{}: names no data set: give --data DIR, or a key 'data'", arguments.config));
  const Dataset dataset = find_dataset(data, config.dataset.layout);
  Workload workload = make_workload(dataset, arguments.items);
  return std::make_unique<Setup>(std::move(config), std::move(workload), arguments);
}

int thread_count(const Arguments& arguments) {
  if (arguments.threads > 0) return arguments.threads;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

Cell as_cell(std::size_t count) { return static_cast<std::int64_t>(count); }

void print_counts(const Setup& setup, const Plan& plan) {
  Table table{.columns = {"stage", "cached", "to compute", "waiting", "not applicable", "failed", "why"},
              .rows = {}};
  std::size_t open = 0;
  for (const StageCount& count : count_by_stage(setup.context, plan)) {
    std::string why;
    for (const auto& [reason, n] : count.reasons)
      why += fmt::format("{}{}: {}", why.empty() ? "" : "; ", reason, n);
    table.rows.push_back({count.stage, as_cell(count.cached), as_cell(count.compute), as_cell(count.wait),
                          as_cell(count.absent), as_cell(count.failed), why});
    open += count.compute + count.wait;
  }
  fmt::print("{}\n", aligned(table));
  fmt::print("{} jobs to do{}\n", open,
             open > 0 ? "; one that waits is skipped where what it waits for comes out as before" : "");
}

void print_failures(const Setup& setup, const std::vector<Failure>& failures) {
  if (failures.empty()) return;
  fmt::print(stderr, "\n{} failed:\n", failures.size());
  for (const Failure& failure : failures)
    fmt::print(stderr, "  {}: {}: {}\n", setup.context.name(failure.item), failure.stage, failure.cause);
}

std::string val_text(const ScalarField& field) {
  std::string lines;
  for (const double value : field) lines += fmt::format("{}\n", value);
  return lines;
}

// Writes TO/MODEL/ITEM.val for every map that is known; returns how many.
std::size_t write_maps(const Setup& setup, const Plan& plan, Runner& runner, const Arguments& arguments) {
  std::size_t written = 0;
  for (const Model& model : setup.config.models) {
    if (!model.is_map()) continue;
    const std::string name = (arguments.matched ? "matched." : "map.") + model.name;
    const fs::path folder = fs::path(arguments.to) / model.name;
    prepare_folder(folder, "--to");
    for (std::size_t f = 0; f < setup.workload.families.size(); ++f) {
      for (const ItemRef& item : setup.context.family(f)) {
        const Chain& chain = setup.context.chain(item);
        if (!has_stage(chain, name) || !plan.jobs(item)[stage_index(chain, name)].known()) continue;
        const Value map = runner.result(item, stage_index(chain, name));
        write_text_file(folder / (setup.context.name(item) + ".val"), val_text(std::get<ScalarField>(map)));
        ++written;
      }
    }
  }
  return written;
}

ExitStatus interrupted_status(const Arguments& arguments) {
  fmt::print(stderr, "\ninterrupted; everything finished so far is kept. To go on:\n  {}\n",
             arguments.command_line);
  return kInterrupted;
}

}  // namespace

ExitStatus run_command(const Arguments& arguments, const std::atomic<bool>& stop) {
  const auto started = std::chrono::steady_clock::now();
  const std::unique_ptr<Setup> setup = set_up(arguments);
  for (const std::string& note : setup->workload.notes) spdlog::warn("{}", note);
  prepare_output(setup->output);
  FolderStore store(setup->cache, Access::read_write);
  Plan plan = make_plan(setup->context, store);

  const std::unique_ptr<Progress> progress = arguments.quiet ? no_progress() : terminal_progress();
  Runner runner(setup->context, plan, store, *progress, stop);
  runner.run(thread_count(arguments));
  if (stop) return interrupted_status(arguments);

  const RunRecord record{setup->config,
                         setup->context,
                         plan,
                         runner,
                         thread_count(arguments),
                         std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count()};
  const std::vector<ResultRow> rows = collect_results(setup->config, setup->context, plan, runner);
  write_results(setup->output, record, rows);
  if (!arguments.quiet) {
    if (setup->config.simulated()) fmt::print("{}\n", kSimulatedNote);
    fmt::print("{}", aligned(summary_table(rows)));
    fmt::print("\nprotocol {}; {} artefacts computed, results in {}\n", name_of(setup->config.protocol),
               runner.computed(), setup->output.string());
  }
  print_failures(*setup, runner.failures());
  return runner.failures().empty() ? kAllDone : kSomeFailed;
}

ExitStatus maps_command(const Arguments& arguments, const std::atomic<bool>& stop) {
  const std::unique_ptr<Setup> setup = set_up(arguments);
  FolderStore store(setup->cache, Access::read_write);
  Plan plan = make_plan(setup->context, store);
  const std::unique_ptr<Progress> progress = arguments.quiet ? no_progress() : terminal_progress();
  Runner runner(setup->context, plan, store, *progress, stop);
  runner.run(thread_count(arguments));
  if (stop) return interrupted_status(arguments);
  const std::size_t written = write_maps(*setup, plan, runner, arguments);
  if (!arguments.quiet) fmt::print("{} maps written to {}\n", written, arguments.to);
  print_failures(*setup, runner.failures());
  return runner.failures().empty() ? kAllDone : kSomeFailed;
}

ExitStatus plan_command(const Arguments& arguments) {
  const std::unique_ptr<Setup> setup = set_up(arguments);
  for (const std::string& note : setup->workload.notes) spdlog::warn("{}", note);
  const FolderStore store(setup->cache, Access::read_only);
  print_counts(*setup, make_plan(setup->context, store));
  return kAllDone;
}

ExitStatus status_command(const Arguments& arguments) {
  const std::unique_ptr<Setup> setup = set_up(arguments);
  const FolderStore store(setup->cache, Access::read_only);
  const Plan plan = make_plan(setup->context, store);
  Table table{.columns = {"stage", "done", "of", "in the cache", "MB"}, .rows = {}};
  const std::vector<FolderStore::Usage> usage = store.usage();
  for (const StageCount& count : count_by_stage(setup->context, plan)) {
    std::size_t artefacts = 0;
    std::uint64_t bytes = 0;
    for (const FolderStore::Usage& stage : usage)
      if (stage.stage == count.stage) std::tie(artefacts, bytes) = std::pair(stage.artefacts, stage.bytes);
    table.rows.push_back({count.stage, as_cell(count.cached),
                          as_cell(count.cached + count.compute + count.wait), as_cell(artefacts),
                          static_cast<double>(bytes) / 1e6});
  }
  fmt::print("{}\ndata set: {} meshes, {} models; cache: {}\n", aligned(table),
             setup->workload.families.size(), setup->config.models.size(), setup->cache.string());
  return kAllDone;
}

}  // namespace salbench
