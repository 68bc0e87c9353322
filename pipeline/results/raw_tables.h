// SPDX-License-Identifier: GPL-3.0-or-later
// Scores beside those of results.csv, as the stages computed them, and their means. All conclusions are drawn
// from these tables by the Python package (python/salbench/conclusions).
#pragma once

#include <string>
#include <vector>

#include "io/table.h"
#include "pipeline/results/results.h"

namespace salbench {

// How well n participants predict n others, on one mesh.
struct MeshCurve {
  std::string item, category;
  HumanCurve curve;
};

// Those of the meshes that HS was computed for, in their order.
std::vector<MeshCurve> collect_human_curves(const RunState& run);

// item, class, n, then a column per metric: scores of n participants against n others.
Table people_table(const std::vector<MeshCurve>& curves, const Metrics& metrics);

// `smoothing`, the number of steps, before the columns of results_table; no rows if the run smooths no maps.
Table smoothed_table(const RunState& run, const Metrics& metrics);

// dataset, model, fold, shapes, blur, gain, of, at, log_density: what was fitted to the maps of each model,
// knot by knot. No rows if no metric reads fitted densities.
Table fitted_table(const RunState& run);

// Rows of a constant map, one for each shape that the rows have, those of a shape being together. `varying`
// has the scores of the metrics whose score of it differs from shape to shape, as collect_constant gives
// them; without one it is NaN.
std::vector<ResultRow> rows_of_constant(const std::vector<ResultRow>& rows,
                                        const std::vector<ResultRow>& varying, const MetricsOptions& options);

// dataset, split (if items have any), metric, model, n, mean: over the meshes or point clouds that the model
// has a score for, of the mean over the scored views of each. For the whole data set, then for each split.
Table means_table(const std::vector<ResultRow>& rows, const Metrics& metrics);

// Splits among the rows of a data set, in their order; none where all rows are of one, or of none.
std::vector<std::string> splits_among(const std::vector<ResultRow>& rows, std::string_view dataset);

}  // namespace salbench
