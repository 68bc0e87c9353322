// SPDX-License-Identifier: GPL-3.0-or-later
// The tables that compare models: by class, pairwise, and by how their values are distributed.
#pragma once

#include <vector>

#include "io/table.h"
#include "pipeline/results/results.h"
#include "stages/stats/unit.h"

namespace salbench {

// dataset, class, model, metric, n (units), n_shapes, mean, ci95_low, ci95_high: over the shapes of the class
// that all competitors have a score for. The model "Avg" is the mean over the competitors, shape by shape, so
// that its interval is one over shapes. Empty where items have no class.
Table per_class_table(const std::vector<ResultRow>& rows, const Metrics& metrics = chosen_metrics({}),
                      Observation unit = Observation::mesh);

// bin_left, then a column for the ground truth (GS) and each model: mean 100-bin density histograms of the
// unmatched, min-max-normalised maps. [tasse2016]
Table mean_histogram_table(const RunState& run, Level level);

}  // namespace salbench
