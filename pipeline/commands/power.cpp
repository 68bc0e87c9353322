// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "io/file.h"
#include "pipeline/commands/score_options.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/results/pairs.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

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

ExitStatus print_power(const Arguments& arguments, ScoreOptions options) {
  if (options.scores.empty()) options.scores = only_results();
  if (fs::is_directory(options.scores)) options.scores = (fs::path(options.scores) / "results.csv").string();
  const auto concluded = conclude_from_file(options);
  const Table table = power_table(concluded->conclusions);
  if (!arguments.to.empty()) write_file(arguments.to, to_csv(table));
  if (!arguments.quiet)
    fmt::print(
        "{}\none observation per {}; detectable: the difference of means that n of them show with "
        "probability {} at 0.05;\nn_to_detect: how many would show a true difference as large as the one "
        "seen\n",
        aligned(table), name_of(concluded->conclusions.unit), kPower);
  return kAllDone;
}

}  // namespace

Subcommand power_subcommand(Arguments& arguments) {
  const auto options = std::make_shared<ScoreOptions>();
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
