#include "pipeline/commands.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/file.h"
#include "io/table.h"
#include "pipeline/causes.h"
#include "pipeline/interrupt.h"
#include "pipeline/results.h"
#include "pipeline/session.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

Cell as_cell(std::size_t count) { return static_cast<std::int64_t>(count); }

void print_counts(const Setup& setup, const Plan& plan) {
  Table table{.columns = {"stage", "cached", "to compute", "waiting", "not applicable", "failed", "why"},
              .rows = {}};
  Causes causes(setup.context, plan, setup.cache, kOpenedForCounting);
  std::size_t open = 0;
  for (const StageCount& count : count_by_stage(setup.context, plan, causes.words())) {
    std::string reasons;
    for (const auto& [reason, n] : count.reasons)
      reasons += fmt::format("{}{}: {}", reasons.empty() ? "" : "; ", reason, n);
    table.rows.push_back({count.stage, as_cell(count.cached), as_cell(count.compute), as_cell(count.wait),
                          as_cell(count.absent), as_cell(count.failed), reasons});
    open += count.compute + count.wait;
  }
  fmt::print("{}\n", aligned(table));
  fmt::print("{} jobs to do{}\n", open,
             open > 0 ? "; a waiting job is skipped if its input turns out unchanged" : "");
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

// Writes TO/MODEL/ITEM.val for every map that is known; returns how many. Ends early once `stop` is set.
std::size_t write_maps(Session& session, const Arguments& arguments, const std::atomic<bool>& stop) {
  const Context& context = session.setup.context;
  std::vector<std::string> models;
  for (const Model& model : session.setup.config.models)
    if (model.is_map()) models.push_back(model.name);
  for (const std::string& model : models)
    make_folder(fs::path(arguments.to) / model, "choose another with --to");
  const std::vector<ItemRef> items = context.items();
  std::size_t written = 0;
  session.progress->begin("writing", items.size());
  for (const ItemRef& item : items) {
    for (const std::string& model : models) {
      if (stop) return written;
      const Chain& chain = context.chain(item);
      const std::string name = (arguments.matched ? "matched." : "map.") + model;
      if (!has_stage(chain, name)) continue;
      const std::size_t stage = stage_index(chain, name);
      if (!session.plan.jobs(item)[stage].known()) continue;
      const Value map = session.runner.result(item, stage);
      write_file(fs::path(arguments.to) / model / (context.name(item) + ".val"),
                 val_text(std::get<ScalarField>(map)));
      ++written;
    }
    session.progress->item_done();
  }
  session.progress->end();
  return written;
}

void print_status(const Setup& setup, const Plan& plan, const FolderStore& store) {
  Table table{.columns = {"stage", "done", "of", "in the cache", "MB"}, .rows = {}};
  std::map<std::string, FolderStore::Usage> usage;
  for (const FolderStore::Usage& stage : store.usage()) usage[stage.stage] = stage;
  for (const StageCount& count : count_by_stage(setup.context, plan)) {
    const FolderStore::Usage& used = usage[count.stage];
    table.rows.push_back({count.stage, as_cell(count.cached),
                          as_cell(count.cached + count.compute + count.wait), as_cell(used.artefacts),
                          static_cast<double>(used.bytes) / 1e6});
  }
  fmt::print("{}\ndata set: {} meshes, {} models; cache: {}; results: {}\n", aligned(table, 1),
             setup.workload.families.size(), setup.config.models.size(), setup.cache.string(),
             setup.output.string());
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

std::string interrupted_text(const Arguments& arguments) {
  return fmt::format("\ninterrupted; everything finished so far is kept. To go on:\n  {}\n",
                     arguments.command_line);
}

ExitStatus interrupted_status(const Arguments& arguments) {
  fmt::print(stderr, "{}", interrupted_text(arguments));
  return kInterrupted;
}

ExitStatus finished_status(const Session& session) {
  const std::vector<Failure>& failures = session.runner.failures();
  print_failures(session.setup, failures);
  if (std::any_of(failures.begin(), failures.end(), [](const Failure& f) { return f.defect; }))
    return kDefect;
  return failures.empty() ? kAllDone : kSomeFailed;
}

ExitStatus run_command(const Arguments& arguments, const std::atomic<bool>& stop) {
  Session session(arguments, stop);
  return run_session(session, arguments, stop);
}

namespace {

// No tables: what they compare is in the other shares.
ExitStatus finish_shard(const Session& session, const RunRecord& record, const Arguments& arguments) {
  const Setup& setup = session.setup;
  write_shard_record(setup.output, record);
  if (!arguments.quiet)
    fmt::print(
        "shard {}: {} meshes, {} artefacts computed; when all shards are done, the same line without "
        "--shard writes the tables\n",
        setup.context.shard->text(), setup.workload.families.size(), session.runner.computed());
  return finished_status(session);
}

}  // namespace

ExitStatus run_session(Session& session, const Arguments& arguments, const std::atomic<bool>& stop) {
  const Setup& setup = session.setup;
  setup.context.shard ? make_folder(setup.output, "choose another with --out") : prepare_output(setup.output);
  {
    const OrderlyEnd orderly;
    session.runner.run(thread_count(arguments));
  }
  if (stop) return interrupted_status(arguments);

  Causes causes(setup.context, session.plan, setup.cache, kOpenedForCounting);
  const RunRecord record{setup.config,
                         setup.context,
                         session.plan,
                         session.runner,
                         thread_count(arguments),
                         seconds_since(session.started),
                         causes.words_of_computed()};
  if (setup.context.shard) return finish_shard(session, record, arguments);
  const std::vector<ResultRow> rows =
      collect_results(setup.config, setup.context, session.plan, session.runner);
  write_results(setup.output, record, rows);
  if (!arguments.quiet) {
    if (setup.config.simulated()) fmt::print("{}\n", kSimulatedNote);
    fmt::print("{}", aligned(summary_table(rows)));
    fmt::print("\nprotocol {}; {} artefacts computed, results in {}\n", name_of(setup.config.protocol),
               session.runner.computed(), setup.output.string());
  }
  return finished_status(session);
}

ExitStatus maps_command(const Arguments& arguments, const std::atomic<bool>& stop) {
  Session session(arguments, stop);
  const OrderlyEnd orderly;
  session.runner.run(thread_count(arguments));
  if (stop) return interrupted_status(arguments);
  const std::size_t written = write_maps(session, arguments, stop);
  if (stop) return interrupted_status(arguments);
  if (!arguments.quiet) fmt::print("{} maps written to {}\n", written, arguments.to);
  return finished_status(session);
}

ExitStatus plan_command(const Arguments& arguments) {
  const Setup setup(arguments);
  const FolderStore store(setup.cache, Access::read_only);
  print_counts(setup, make_plan(setup.context, store));
  return kAllDone;
}

ExitStatus status_command(const Arguments& arguments) {
  const Setup setup(arguments);
  const FolderStore store(setup.cache, Access::read_only);
  print_status(setup, make_plan(setup.context, store), store);
  return kAllDone;
}

}  // namespace salbench
