// SPDX-License-Identifier: GPL-3.0-or-later
// Scores per shape from a table of anybody's: results.csv of a run, or what others have published.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/table.h"
#include "pipeline/results/results.h"

namespace salbench {

struct ScoreFile {
  std::vector<ResultRow> rows;
  Metrics metrics;                 // by name, direction and nothing else
  std::vector<std::string> notes;  // remarks of the file; columns that were left out
};

struct ScoreColumns {
  std::vector<std::string> higher_is_better, lower_is_better;  // beside the metrics of the program
};

// A CSV file with a row per shape and model. Columns: item, model and at least one metric; dataset, view and
// class if there are any. Without `dataset`, rows with a view are scans and others are meshes; `lcc` is made
// of `cc` where it is missing. `classes` is a CSV file with columns item and class, if not empty. Throws
// InputError that names file and line for a missing column, a score that is no number, and a shape that a
// model has two rows of.
ScoreFile read_scores(const std::filesystem::path& path, const ScoreColumns& columns = {},
                      const std::filesystem::path& classes = {});

// The same of a table in memory. Where it has `lines`, these are named, beside its name.
ScoreFile scores_from(const Table& table, const ScoreColumns& columns = {},
                      const std::filesystem::path& classes = {});

// The columns that are scores: metrics of the program, and those named.
std::vector<std::string> names_of_scores(const Table& table, const ScoreColumns& columns = {});

}  // namespace salbench
