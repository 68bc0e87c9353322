// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/score_options.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "pipeline/catalog/config.h"
#include "stages/core/errors.h"

namespace salbench {
Parameters score_parameters(ScoreOptions& options, Parameter scores, const Parameters& further) {
  Parameters parameters = {
      std::move(scores),
      {"--classes", &options.classes, "CSV file with columns item and class"},
      {"--unit", &options.unit, "what counts as one observation: mesh (default), class or shape"},
      {"--higher", &options.higher, "further columns of scores of which higher ones are better"},
      {"--lower", &options.lower, "further columns of scores of which lower ones are better"}};
  parameters.insert(parameters.end(), further.begin(), further.end());
  return parameters;
}

std::unique_ptr<ConcludedScores> conclude_from_file(const ScoreOptions& options) {
  Unit unit = StatisticsOptions{}.unit;
  if (!options.unit.empty() && !parse_option(options.unit, unit))
    throw ConfigError(fmt::format("--unit {}: must be {}", options.unit, expected_of<Unit>()));
  auto concluded = std::make_unique<ConcludedScores>();
  concluded->file =
      read_scores(options.scores, {split_list(options.higher), split_list(options.lower)}, options.classes);
  for (const std::string& note : concluded->file.notes) spdlog::warn("{}", note);
  concluded->conclusions =
      conclude(concluded->file.rows, concluded->file.metrics, {.unit = unit}, kDefaultSeed);
  return concluded;
}

}  // namespace salbench
