// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of a run: scores as the stages computed them, with the metrics that they hold, and their means.
// All conclusions are drawn from these by the Python package (python/salbench/conclusions).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/table.h"
#include "pipeline/results/results.h"

namespace salbench {

Table results_table(const std::vector<ResultRow>& rows, const Metrics& metrics = chosen_metrics({}));

// dataset, split (if items have any), metric, model, n, mean: over the meshes or point clouds that the model
// has a score for, of the mean over the scored views of each. For the whole data set, then for each split.
Table means_table(const std::vector<ResultRow>& rows, const Metrics& metrics);

// Rows of a constant map, one for each shape that the rows have, those of a shape being together. `varying`
// has the scores of the metrics whose score of it differs from shape to shape, as collect_constant gives
// them; without one it is NaN.
std::vector<ResultRow> rows_of_constant(const std::vector<ResultRow>& rows,
                                        const std::vector<ResultRow>& varying, const MetricsOptions& options);

// item, class, n, then a column per metric: scores of n participants against n others, on the meshes that HS
// was computed for; no rows if there are none.
Table people_table(const RunState& run, const Metrics& metrics);

// `smoothing`, the number of steps, before the columns of results_table; no rows if the run smooths no maps.
Table smoothed_table(const RunState& run, const Metrics& metrics);

struct TableFile {
  std::string name;
  std::optional<std::string> text = {};  // nothing: the run has none, and one of an earlier run goes
  bool is_of_scores = true;              // conclusions are drawn from it
};

// results.csv, means.csv, constant.csv, people.csv where HS was computed, smoothed.csv where maps were
// smoothed, gaze.csv where the ground truth was made of recordings, and
// mean_histograms_{meshes,scans,clouds}.csv. Each repeats the remarks.
std::vector<TableFile> table_files(const RunState& run, const std::vector<ResultRow>& rows,
                                   const std::vector<std::string>& remarks);

// The Python package writes it after the run of a cross-validation.
inline constexpr std::string_view kFoldsTable = "folds.csv";

// Every table that a run may leave: these, costs.csv and that of the folds.
std::vector<std::string> names_of_tables();

}  // namespace salbench
