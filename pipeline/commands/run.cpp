// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/run.h"

#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/commands/process.h"
#include "io/file.h"
#include "io/table.h"
#include "pipeline/commands/cli.h"
#include "pipeline/commands/conclude.h"
#include "pipeline/commands/output_folder.h"
#include "pipeline/engine/run.h"
#include "pipeline/results/counts.h"
#include "pipeline/results/record.h"
#include "pipeline/results/tables.h"

namespace salbench {
namespace {

constexpr const char* kPartialNote =
    "PARTIAL: the run was interrupted; these are the scores of what it finished and they are final.";

// No tables: what they compare is in the other shares.
std::string shard_text(const Session& session) {
  return fmt::format(
      "shard {}: {}, {} artefacts computed; when all shards are done, the same line without "
      "--shard writes the tables\n",
      session.setup.inputs.shard->text(), session.setup.inputs.text(), session.resolver.computed());
}

Json rows_json(const Table& table) {
  return list_of(table.rows, [&](const std::vector<Cell>& row) {
    Json object;
    for (std::size_t column = 0; column < row.size(); ++column)
      object[table.columns[column]] = csv_text(row[column]);
    return object;
  });
}

// As means.csv has them: what there is to show without conclusions.
Table means_of(Session& session) {
  return means_table(collect_results(session.state()), chosen_metrics(session.setup.config.metrics));
}

// The last lines say who leads, which maps are new, and where the tables are.
std::string summary_text(Session& session, const Concluded& concluded, const std::vector<MapCount>& maps) {
  const Setup& setup = session.setup;
  std::string text = concluded.text;
  if (!concluded)
    text = fmt::format("{}\n{}", aligned(means_of(session)),
                       setup.config.simulated() ? fmt::format("{}\n", kSimulatedNote) : "");
  return fmt::format(
      "{}{}protocol {}; {} artefacts computed, results in {}\nto make a report of them: salbench report {}\n",
      text, aligned(map_table(maps)), name_of(setup.config.protocol), session.resolver.computed(),
      setup.output.string(), shell_quoted(setup.output.string()));
}

// Returns what names them; empty if an interrupted run has none.
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
    remove_scores(session.setup.output);
    return {};
  }
  return write_scores(session.setup.output, run, rows, remarks);
}

}  // namespace

std::string run_and_write(Session& session, int threads) {
  const Setup& setup = session.setup;
  // Here alone: who plans or exports a run knows its data set.
  for (const std::string& note : setup.inputs.notes) spdlog::warn("{}", note);
  if (has_work(session.resolver))
    session.store.prepare();  // before the results of an earlier run are touched
  const auto& shard = setup.inputs.shard;
  const std::string selection = selection_yaml(setup.selection);
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

Json summary_of(const Session& session) {
  const Setup& setup = session.setup;
  return {{"meshes", setup.inputs.count(kMeshes)},
          {"clouds", setup.inputs.count(kClouds)},
          {"models", setup.config.models.size()},
          {"cache", setup.cache},
          {"computed", session.resolver.computed()},
          {"interrupted", session.stop.load()},
          {"failed", list_of(session.resolver.failures(), [&](const Failure& failure) {
             return Json{{"item", setup.project.name(failure.job)},
                         {"stage", setup.project.rule(failure.job).stage},
                         {"why", failure.cause}};
           })}};
}

namespace {

ExitStatus run_session(Session& session, const Arguments& arguments) {
  const Setup& setup = session.setup;
  const bool in_shares = setup.inputs.shard.has_value();
  const std::string scores = run_and_write(session, arguments.threads);
  allow_commands();  // after an interrupt, too: the scores of what was finished are concluded
  const Concluded concluded = scores.empty() ? Concluded{} : conclude_results(setup.output, scores);
  Json document = {{"results", setup.output},
                   {"protocol", name_of(setup.config.protocol)},
                   {"simulated", setup.config.simulated()},
                   {"shard", in_shares ? Json(setup.inputs.shard->text()) : Json()},
                   {"scores", Json::array()},
                   {"leaders", Json::array()}};
  std::string text;
  const std::vector<MapCount> maps = count_maps(session.resolver, session.store);
  if (!session.stop) text = in_shares ? shard_text(session) : summary_text(session, concluded, maps);
  if (!session.stop && !in_shares) {
    document["scores"] = concluded ? concluded.scores : rows_json(means_of(session));
    document["leaders"] = concluded.leaders;
  }
  document["maps"] = list_of(maps, [](const MapCount& count) {
    return Json{{"model", count.model}, {"computed", count.computed}, {"read", count.read}};
  });
  document.update(summary_of(session));
  print_report(arguments.format, "run", document, arguments.quiet ? "" : text);
  const bool in_trouble = report_trouble(concluded, setup.output);
  if (!session.stop) return in_trouble ? kDefect : finished_status(session);
  if (!in_shares)
    std::fputs(fmt::format("\n{}: {}\n", setup.output.string(), state_of_results(setup.output)).c_str(),
               stderr);
  return interrupted_status();
}

ExitStatus run_benchmark(const Arguments& arguments) {
  prepare_commands();  // one draws the conclusions, when the program is large
  Session session(arguments);
  return run_session(session, arguments);
}

}  // namespace

Action run_subcommand(CLI::App& program) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& app = add_subcommand(
      program, "run", "compute what is missing and write the tables",
      {{"run configs/shrec07.yaml --data SchellingData", "the whole benchmark; run it again to resume"},
       {"run configs/shrec07.yaml --data SchellingData --items 1-20,52",
        "these, matched to the mean over all"},
       {"run configs/shrec07.yaml --data SchellingData --items scored", "all shapes that have ground truth"},
       {"run configs/shrec07.yaml --data SchellingData --shard 2/4", "the second of four shares"},
       {"run configs/shrec07_meshes.yaml --data SchellingData --maps mine --name MINE",
        "and your maps: mine/52.val"},
       {"run configs/shrec07_meshes.yaml --data SchellingData --maps mine.h5 --name MINE --models RS",
        "beside chance alone"}});
  add_running(app, *arguments);
  add_output(app, *arguments);
  add_shard(app, *arguments);
  app.add_option("--models", arguments->models, "only these of the configuration, such as LS,PS");
  add_given_maps(
      app, *arguments,
      "also score maps that any program made: a folder with ITEM.val (52.val of a mesh, 52_3.val of "
      "its scan 3; one value per line), or an HDF5 file with a data set ITEM; over what has ground "
      "truth, if --items does not name others");
  add_format(app, *arguments);
  return [arguments] { return run_benchmark(*arguments); };
}

}  // namespace salbench
