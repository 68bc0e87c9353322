// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/conclusions.h"

#include <memory>

#include <fmt/format.h>

#include "io/file.h"
#include "pipeline/commands/score_options.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/results/statements.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

struct Options {
  ScoreOptions scores;
  std::string statements;
};

ExitStatus write_all(const Arguments& arguments, const Options& options) {
  std::vector<Statement> statements;
  if (!options.statements.empty()) statements = read_statements(options.statements);
  const auto concluded = conclude_from_file(options.scores);
  const fs::path folder = arguments.output.empty()
                              ? fs::path("salbench-out") / fs::path(options.scores.scores).stem()
                              : fs::path(arguments.output);
  make_folder(folder, "choose another with --out");
  write_conclusions(folder, concluded->file.rows, concluded->conclusions, "");
  if (!options.statements.empty())
    write_file(folder / "statements.csv", to_csv(statements_table(concluded->conclusions, statements)));
  if (!arguments.quiet)
    fmt::print("{}\none observation per {}; tables in {}\n", aligned(overview_table(concluded->conclusions)),
               name_of(concluded->conclusions.unit), folder.string());
  return kAllDone;
}

}  // namespace

Subcommand conclusions_subcommand(Arguments& arguments) {
  const auto options = std::make_shared<Options>();
  return {"conclusions",
          "means, intervals, tests and ranks of a table of scores per shape, of a run or of anybody's",
          score_parameters(
              options->scores,
              {"SCORES", &options->scores.scores,
               "CSV file with columns item, model, metrics, and view of scans", true},
              {{"--statements", &options->statements,
                "CSV file of what a text says of pairs of models, like configs/paper/claims.csv: each beside "
                "what the scores say, in statements.csv"},
               {"--out", &arguments.output, "folder of the tables (default: salbench-out/NAME)"},
               {"--quiet", &arguments.quiet, "no table; warnings and errors only"}}),
          [&arguments, options](const std::atomic<bool>&) { return write_all(arguments, *options); }};
}

}  // namespace salbench
