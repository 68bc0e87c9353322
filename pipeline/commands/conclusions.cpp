// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/conclusions.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/file.h"
#include "io/table.h"
#include "pipeline/catalog/config.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/config/section.h"
#include "pipeline/results/score_file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string scores, classes, unit, higher, lower;
};

Unit unit_named(const std::string& name) {
  if (name.empty()) return StatisticsOptions{}.unit;
  const auto& names = EnumNames<Unit>::names;
  const auto found = std::ranges::find(names, name);
  if (found == names.end())
    throw ConfigError(fmt::format("--unit {}: must be one of {}", name, fmt::join(names, ", ")));
  return static_cast<Unit>(found - names.begin());
}

ExitStatus conclude_from_file(const Arguments& arguments, const Options& options) {
  const ScoreFile file =
      read_scores(options.scores, {split_list(options.higher), split_list(options.lower)}, options.classes);
  for (const std::string& note : file.notes) spdlog::warn("{}", note);
  const Conclusions conclusions =
      conclude(file.rows, file.metrics, {.unit = unit_named(options.unit)}, kDefaultSeed);
  const fs::path folder = arguments.output.empty()
                              ? fs::path("salbench-out") / fs::path(options.scores).stem()
                              : fs::path(arguments.output);
  make_folder(folder, "choose another with --out");
  write_conclusions(folder, file.rows, conclusions, "");
  if (!arguments.quiet)
    fmt::print("{}\none observation per {}; tables in {}\n", aligned(overview_table(conclusions)),
               name_of(conclusions.unit), folder.string());
  return kAllDone;
}

}  // namespace

Subcommand conclusions_subcommand(Arguments& arguments) {
  const auto options = std::make_shared<Options>();
  return {
      "conclusions",
      "means, intervals, tests and ranks of a table of scores per shape, of a run or of anybody's",
      {{"SCORES", &options->scores, "CSV file with columns item, model, metrics, and view of scans", true},
       {"--classes", &options->classes, "CSV file with columns item and class"},
       {"--unit", &options->unit, "what counts as one observation: mesh (default), class or shape"},
       {"--higher", &options->higher, "further columns of scores of which higher ones are better"},
       {"--lower", &options->lower, "further columns of scores of which lower ones are better"},
       {"--out", &arguments.output, "folder of the tables (default: salbench-out/NAME)"},
       {"--quiet", &arguments.quiet, "no table; warnings and errors only"}},
      [&arguments, options](const std::atomic<bool>&) { return conclude_from_file(arguments, *options); }};
}

}  // namespace salbench
