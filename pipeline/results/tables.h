// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of a run: scores as the stages computed them, with their metrics, and means. The Python package
// draws all conclusions from these (python/salbench/conclusions).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/table.h"
#include "pipeline/results/results.h"

namespace salbench {

Table results_table(const std::vector<ResultRow>& rows, const Metrics& metrics = chosen_metrics({}));

// dataset, split (if items have any), metric, model, n, mean: over the n meshes or point clouds with a score
// of the model, each the mean over its scored views. For the whole data set, then for each split.
Table means_table(const std::vector<ResultRow>& rows, const Metrics& metrics);

// Rows of a constant map, one per shape of `rows`, where a shape's rows are adjacent. `varying` holds the
// scores that differ between shapes, as collect_constant returns them; missing ones are NaN.
std::vector<ResultRow> rows_of_constant(const std::vector<ResultRow>& rows,
                                        const std::vector<ResultRow>& varying, const MetricsOptions& options);

// item, class, n, then one column per metric: scores of n participants against n others, on the meshes with
// HS; no rows if there are none.
Table people_table(const RunState& run, const Metrics& metrics);

// `smoothing` (number of steps), then the columns of results_table; no rows if no maps are smoothed.
Table smoothed_table(const RunState& run, const Metrics& metrics);

struct TableFile {
  std::string name;
  std::optional<std::string> text = {};  // nullopt: this run has none, and an earlier run's file is removed
  bool is_of_scores = true;              // input of conclusions
};

// results.csv, means.csv, constant.csv, people.csv (if HS was computed), smoothed.csv (if maps were
// smoothed), gaze.csv (if ground truth comes from recordings), and mean_histograms_{meshes,scans,clouds}.csv.
// Each repeats the remarks.
std::vector<TableFile> table_files(const RunState& run, const std::vector<ResultRow>& rows,
                                   const std::vector<std::string>& remarks);

// Written by the Python package after a cross-validation.
inline constexpr std::string_view kFoldsTable = "folds.csv", kTrainingTable = "training.csv";

// Every table that a run may leave: these, costs.csv and those of a cross-validation.
std::vector<std::string> names_of_tables();

}  // namespace salbench
