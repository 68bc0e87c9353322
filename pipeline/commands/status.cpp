// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>

#include <fmt/format.h>

#include "io/table.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/results/record.h"

namespace salbench {
namespace {

ExitStatus print_status(const Arguments& arguments) {
  const Setup setup(arguments, {}, Pictures::cached);
  const FolderStore store(setup.cache, Access::read_only);
  const Plan plan = make_plan(setup.context, store);
  Table table{.columns = {"stage", "done", "of", "in the cache", "MB"}, .rows = {}};
  std::map<std::string, FolderStore::Usage> usage;
  for (const FolderStore::Usage& stage : store.usage()) usage[stage.stage] = stage;
  for (const RowCount& count : count_by_name(setup.context, plan)) {
    const FolderStore::Usage& used = usage[count.stage];
    table.rows.push_back({count.stage, cell_of(count.cached),
                          cell_of(count.cached + count.compute + count.wait), cell_of(used.artefacts),
                          static_cast<double>(used.bytes) / 1e6});
  }
  const std::string state = state_of_results(setup.output);
  fmt::print("{}\ndata set: {}, {} models; cache: {}\n", aligned(table, 1), shapes_text(setup.workload),
             setup.config.models.size(), setup.cache.string());
  if (!state.empty()) fmt::print("last run: {}\n", state);
  fmt::print("results: {}\n", setup.output.string());  // the last line and nothing else: scripts/slurm/submit
  return kAllDone;
}

}  // namespace

Subcommand status_subcommand(Arguments& arguments) {
  return {"status", "count what is in the cache; changes nothing", run_parameters(arguments),
          [&arguments](const std::atomic<bool>&) { return print_status(arguments); }};
}

}  // namespace salbench
