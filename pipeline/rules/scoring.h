// SPDX-License-Identifier: GPL-3.0-or-later
// Rules of how maps are compared with people: the reference that they are matched to, and scores.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/rules/config.h"
#include "pipeline/rules/models.h"
#include "pipeline/rules/values.h"

namespace salbench {

// What metrics draw of a shape: the same for all models and for people. A model's name moves no score, and
// differences between models are free of the noise that the draws have in common.
Rng draws_of_scores(const RandomSource& random);

// The mean histogram of the ground truth, or the one given.
Output<Histogram> add_reference(RuleTable& table, Level level, const Output<GroundTruth>& truth,
                                const std::optional<Histogram>& given);

// Only where a metric asks for it: of other configurations no job, and no key, knows of it.
void add_centre_densities(RuleTable& table, ShapeOutputs& shape, const Config& config);

// The map of a model, and its scores; `smoothing` names the steps after which it is scored, too.
Output<Scores> add_model(RuleTable& table, const ShapeOutputs& shape, const Config& config,
                         const MetricsOptions& smoothing, const Model& model);

// Scores of a constant map by the metrics that score it otherwise on each shape: what models are compared
// with in remarks. Not read where there is no such metric.
Output<Scores> add_constant_scores(RuleTable& table, const ShapeOutputs& shape, const Config& config);

struct Scored {
  Level level = kMeshes;
  std::string model;
  Output<Scores> scores;
};
// A table of each, of maps and of people alike: results are read from a few files, not from thousands.
void add_score_tables(RuleTable& table, const std::vector<Scored>& scored);

}  // namespace salbench
