// SPDX-License-Identifier: GPL-3.0-or-later
// How often intervals hold and tests err, over simulated scores of models that are equal by construction.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/results/conclusions.h"

namespace salbench {

// Standard deviations of what a score is the sum of; all normal.
struct ScoreModel {
  double mesh = 1, view = 1;                    // what all models share: how hard a mesh is, and a view of it
  double model_of_mesh = 1, model_of_view = 1;  // what a model does otherwise on a mesh, and on a view
  std::size_t models = 4, meshes = 30, views = 12;
};

// Estimated from the scores of the competitors under a metric: analysis of variance, components below 0
// being 0.
ScoreModel score_model(const std::vector<ResultRow>& rows, std::string_view dataset, std::size_t metric);

struct Rate {
  std::string what;
  double expected = 0;  // nominal
  std::int64_t hits = 0, cases = 0;

  double value() const { return static_cast<double>(hits) / static_cast<double>(cases); }
};

// One rate per kind of interval and test, in the order of the tables.
std::vector<Rate> calibrate(const ScoreModel& model, std::size_t data_sets, std::uint64_t seed);

}  // namespace salbench
