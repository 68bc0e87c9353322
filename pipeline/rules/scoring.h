// SPDX-License-Identifier: GPL-3.0-or-later
// Rules that compare maps with people: the reference for matching, and scores.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/rules/config.h"
#include "pipeline/rules/models.h"
#include "pipeline/rules/values.h"

namespace salbench {

// Random draws of metrics on a shape, common to all models and to people: a model's name does not affect its
// score, and differences between models contain no noise from different draws.
Rng draws_of_scores(const RandomSource& random);

// Mean histogram of the ground truth, or the given one.
Output<Histogram> add_reference(RuleTable& table, Level level, const Output<GroundTruth>& truth,
                                const std::optional<Histogram>& given);

// Adds rules only if a metric needs them; other configurations have neither their jobs nor keys.
void add_centre_densities(RuleTable& table, ShapeOutputs& shape, const Config& config);

// Map and scores of a model; `smoothing` lists the steps after which it is scored as well.
Output<Scores> add_model(RuleTable& table, const ShapeOutputs& shape, const Config& config,
                         const MetricsOptions& smoothing, const Model& model);

// Scores of a constant map by the metrics for which they vary between shapes, for remarks on models; no
// output without such metrics.
Output<Scores> add_constant_scores(RuleTable& table, const ShapeOutputs& shape, const Config& config);

struct Scored {
  Level level = kMeshes;
  std::string model;
  Output<Scores> scores;
};
// One table each for models and people: results are then read from a few files instead of thousands.
void add_score_tables(RuleTable& table, const std::vector<Scored>& scored);

}  // namespace salbench
