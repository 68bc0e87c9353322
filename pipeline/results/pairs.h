// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs of models: which differ, by how much, and what the data could have shown.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "pipeline/results/conclusions.h"
#include "stages/stats/paired.h"
#include "stages/stats/rank_tests.h"

namespace salbench {

// Model a against model b, as a - b.
struct ModelPair {
  std::size_t a = 0, b = 0;   // as DatasetScores numbers them
  std::int64_t n_shapes = 0;  // that both, and all competitors, have a score for
  PairedComparison by_unit;   // of them
  SignedRank signed_rank;
  double holm = std::numeric_limits<double>::quiet_NaN();  // its p-value, corrected for all pairs
  RankSum by_shape;  // the paper's: over all shapes of each, whatever the unit
};

// Without the correction, which takes all pairs.
ModelPair compare_models(const DatasetScores& scores, std::size_t metric, std::size_t a, std::size_t b);

// Every pair of models that have scores of a metric, a before b.
std::vector<ModelPair> model_pairs(const DatasetScores& scores, std::size_t metric);

// The table of `salbench power` (docs/data_dictionary.md): which differences the scores could have shown.
// [cohen1988]
Table power_table(const Conclusions& conclusions);

}  // namespace salbench
