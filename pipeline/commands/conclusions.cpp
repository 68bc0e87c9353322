// SPDX-License-Identifier: GPL-3.0-or-later
// Subcommands `conclusions` and `power`: what a table of scores per shape shows, and what it could show.
#include "pipeline/results/conclusions.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/file.h"
#include "pipeline/commands/leading.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/commands/summary.h"
#include "pipeline/results/pairs.h"
#include "pipeline/results/score_file.h"
#include "pipeline/results/statements.h"
#include "pipeline/rules/config.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string scores, classes, unit, higher, lower, statements;
  FormatWord format = default_format();
};

Parameters score_parameters(Options& options, Parameter scores, const Parameters& further) {
  Parameters parameters = {
      std::move(scores),
      {"--classes", &options.classes, "CSV file with columns item and class"},
      {"--unit", &options.unit, "what counts as one observation: mesh (default), class or shape"},
      {"--higher", &options.higher, "further columns of scores of which higher ones are better"},
      {"--lower", &options.lower, "further columns of scores of which lower ones are better"},
      format_parameter(options.format)};
  parameters.insert(parameters.end(), further.begin(), further.end());
  return parameters;
}

// Warns of columns that are left out.
ScoreFile scores_of(const Options& options) {
  ScoreFile file =
      read_scores(options.scores, {split_list(options.higher), split_list(options.lower)}, options.classes);
  for (const std::string& note : file.notes) spdlog::warn("{}", note);
  return file;
}

Observation unit_of(const Options& options) {
  Observation unit = StatisticsOptions{}.unit;
  if (!options.unit.empty() && !parse_option(options.unit, unit))
    throw ConfigError(fmt::format("--unit {}: must be {}", options.unit, expected_of<Observation>()));
  return unit;
}

Conclusions conclusions_of(const ScoreFile& file, Observation unit) {
  return conclude(file.rows, file.metrics, {.unit = unit}, kDefaultSeed);
}

ExitStatus write_all(const Arguments& arguments, const Options& options) {
  const ReportFormat format = format_of(options.format);
  std::vector<Statement> statements;
  if (!options.statements.empty()) statements = read_statements(options.statements);
  const Observation unit = unit_of(options);
  const ScoreFile file = scores_of(options);
  const Conclusions conclusions = conclusions_of(file, unit);
  const fs::path folder = arguments.output.empty()
                              ? fs::path("salbench-out") / fs::path(options.scores).stem()
                              : fs::path(arguments.output);
  make_folder(folder, "choose another with --out");
  write_conclusions(folder, file.rows, conclusions, "");
  if (!options.statements.empty())
    write_file(folder / "statements.csv", to_csv(statements_table(conclusions, statements)));
  const Table overview = overview_table(conclusions);
  const std::vector<LevelLeaders> leaders = find_leaders(conclusions);
  const std::string text = fmt::format("{}\n{}one observation per {}; tables in {}\n", aligned(overview),
                                       leading_text(leaders), name_of(unit), folder.string());
  print_report(format, "conclusions",
               {{"results", folder},
                {"unit", name_of(unit)},
                {"scores", rows_json(overview)},
                {"leaders", json_of(leaders)}},
               arguments.quiet ? "" : text);
  return kAllDone;
}

// The only results below salbench-out.
std::string only_results() {
  std::vector<std::string> found;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator("salbench-out", none))
    if (fs::exists(entry.path() / "results.csv", none)) found.push_back(entry.path().string());
  std::ranges::sort(found);
  if (found.size() == 1) return found.front();
  throw ConfigError(found.empty() ? std::string("salbench-out has no results: name their folder")
                                  : fmt::format("name one of the results: {}", fmt::join(found, ", ")));
}

ExitStatus print_power(const Arguments& arguments, Options options) {
  const ReportFormat format = format_of(options.format);
  if (options.scores.empty()) options.scores = only_results();
  if (fs::is_directory(options.scores)) options.scores = (fs::path(options.scores) / "results.csv").string();
  const Observation unit = unit_of(options);
  const ScoreFile file = scores_of(options);
  const Table table = power_table(conclusions_of(file, unit));
  if (!arguments.to.empty()) write_file(arguments.to, to_csv(table));
  const std::string text = fmt::format(
      "{}\none observation per {}; detectable: the difference of means that n of them show with "
      "probability {} at 0.05;\nn_to_detect: how many would show a true difference as large as the one "
      "seen\n",
      aligned(table), name_of(unit), kPower);
  print_report(format, "power", {{"unit", name_of(unit)}, {"pairs", rows_json(table)}},
               arguments.quiet ? "" : text);
  return kAllDone;
}

}  // namespace

Subcommand conclusions_subcommand(Arguments& arguments) {
  const auto options = std::make_shared<Options>();
  return {
      "conclusions",
      "means, intervals, tests and ranks of a table of scores per shape, of a run or of anybody's",
      score_parameters(
          *options,
          {"SCORES", &options->scores, "CSV file with columns item, model, metrics, and view of scans", true},
          {{"--statements", &options->statements,
            "CSV file of what a text says of pairs of models, like configs/paper/claims.csv: each beside "
            "what the scores say, in statements.csv"},
           {"--out", &arguments.output, "folder of the tables (default: salbench-out/NAME)"},
           {"--quiet", &arguments.quiet, "no table; warnings and errors only"}}),
      [&arguments, options](const std::atomic<bool>&) { return write_all(arguments, *options); }};
}

Subcommand power_subcommand(Arguments& arguments) {
  const auto options = std::make_shared<Options>();
  return {"power",
          "which differences between models the scores can show, and how many meshes would show those seen",
          score_parameters(*options,
                           {"OUT", &options->scores,
                            "results folder of a run, or a CSV file as of conclusions (default: the one in "
                            "salbench-out)"},
                           {{"--to", &arguments.to, "CSV file to write the table to"},
                            {"--quiet", &arguments.quiet, "no table; warnings and errors only"}}),
          [&arguments, options](const std::atomic<bool>&) { return print_power(arguments, *options); }};
}

}  // namespace salbench
