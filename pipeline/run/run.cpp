// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run/run.h"

#include <algorithm>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/file.h"
#include "pipeline/engine/run.h"
#include "pipeline/results/record.h"
#include "pipeline/results/tables.h"
#include "pipeline/run/results_folder.h"

namespace salbench {
namespace {

constexpr const char* kPartialNote =
    "PARTIAL: the run was interrupted; these are the scores of what it finished and they are final.";

// Returns the digest of the scores; empty if an interrupted run has none.
std::string write_tables(Session& session, bool interrupted) {
  const RunState run = session.state();
  const std::vector<ResultRow> rows = collect_results(run);
  std::vector<std::string> remarks;
  if (interrupted) remarks.emplace_back(kPartialNote);
  if (run.config.simulated()) remarks.emplace_back(kSimulatedNote);
  if (!run.inputs.remark.empty()) remarks.push_back(run.inputs.remark);
  for (const std::string& remark : training_remarks(run)) {
    spdlog::warn("{}", remark);
    remarks.push_back(remark);
  }
  if (interrupted && rows.empty()) {
    remove_scores(session.setup.output, run);
    return {};
  }
  return write_scores(session.setup.output, run, rows, remarks);
}

// Throws ConfigError, before anything is computed, if conclusions need classes and no item has one.
void require_classes(const Setup& setup) {
  if (setup.config.statistics.unit != Observation::item_class || setup.inputs.shard) return;
  if (std::ranges::none_of(setup.inputs.units.families(), [](const Family& family) {
        return family.chosen && !item_of(family.source).category.empty();
      }))
    throw ConfigError("statistics: unit is class, but no item has a class: write unit: mesh");
}

}  // namespace

std::string run_and_write(Session& session, int threads) {
  const Setup& setup = session.setup;
  require_classes(setup);
  // Not in planning and exports, where the data set's notes are known already.
  for (const std::string& note : setup.inputs.notes) spdlog::warn("{}", note);
  if (has_work(session.resolver)) session.store.prepare();  // before earlier results are touched
  const auto& shard = setup.inputs.shard;
  const std::string selection = selection_lines(setup.selection);
  if (shard)
    make_folder(setup.output, "choose another with " + as_option("out"));
  else
    begin_results(setup.output, unfinished_record(setup.config, selection));
  session.compute(threads);
  const bool interrupted = session.stop;
  if (interrupted && shard) return {};
  RunRecord record{session.state(), session.store, threads, session.seconds(), interrupted, {}, selection};
  if (!shard) record.scores = write_tables(session, interrupted);
  write_record(setup.output, record);
  return record.scores;
}

Table means_of(Session& session) {
  return means_table(collect_results(session.state()), chosen_metrics(session.setup.config.metrics));
}

}  // namespace salbench
