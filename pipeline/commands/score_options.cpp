// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/score_options.h"

#include <algorithm>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "pipeline/config/section.h"
#include "pipeline/rules/config.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

Observation unit_named(const std::string& name) {
  if (name.empty()) return StatisticsOptions{}.unit;
  const auto& names = EnumNames<Observation>::names;
  const auto found = std::ranges::find(names, name);
  if (found == names.end())
    throw ConfigError(fmt::format("--unit {}: must be one of {}", name, fmt::join(names, ", ")));
  return static_cast<Observation>(found - names.begin());
}

}  // namespace

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
  const Observation unit = unit_named(options.unit);
  auto concluded = std::make_unique<ConcludedScores>();
  concluded->file =
      read_scores(options.scores, {split_list(options.higher), split_list(options.lower)}, options.classes);
  for (const std::string& note : concluded->file.notes) spdlog::warn("{}", note);
  concluded->conclusions =
      conclude(concluded->file.rows, concluded->file.metrics, {.unit = unit}, kDefaultSeed);
  return concluded;
}

}  // namespace salbench
