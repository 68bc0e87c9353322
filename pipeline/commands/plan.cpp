// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "io/table.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/plan/causes.h"

namespace salbench {
namespace {

ExitStatus print_plan(const Arguments& arguments) {
  const Setup setup(arguments);
  const FolderStore store(setup.cache, Access::read_only);
  const Plan plan = make_plan(setup.context, store);
  Table table{.columns = {"stage", "cached", "to compute", "waiting", "not applicable", "failed", "why"},
              .rows = {}};
  Causes causes(setup.context, plan, setup.cache, kOpenedForCounting);
  std::size_t open = 0;
  for (const RowCount& count : count_by_name(setup.context, plan, causes.words())) {
    std::string reasons;
    for (const auto& [reason, n] : count.reasons)
      reasons += fmt::format("{}{}: {}", reasons.empty() ? "" : "; ", reason, n);
    table.rows.push_back({count.stage, cell_of(count.cached), cell_of(count.compute), cell_of(count.wait),
                          cell_of(count.not_applicable), cell_of(count.failed), reasons});
    open += count.compute + count.wait;
  }
  fmt::print("{}\n", aligned(table));
  fmt::print("{} jobs to do{}\n", open,
             open > 0 ? "; a waiting job is skipped if its input turns out unchanged" : "");
  return kAllDone;
}

}  // namespace

Subcommand plan_subcommand(Arguments& arguments) {
  return {"plan", "count what a run would compute, and why; changes nothing",
          run_parameters(arguments, {shard_parameter(arguments)}),
          [&arguments](const std::atomic<bool>&) { return print_plan(arguments); }};
}

}  // namespace salbench
