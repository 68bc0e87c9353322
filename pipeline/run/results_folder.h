// SPDX-License-Identifier: GPL-3.0-or-later
// Results folder of a run. Two concurrent runs into one folder leave complete files of either. The Python
// package draws conclusions and writes conclusions.json last: if it exists, all conclusion tables do, and
// belong to the scores that it names.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/results/results.h"

namespace salbench {

// Creates the folder and marks a run in progress. record: text from which the run can be repeated. Throws
// StorageError, and ConfigError if files with a run's names do not come from one.
void begin_results(const std::filesystem::path& folder, const std::string& record);

// Writes the tables of a run, after removing conclusions from other scores. Returns a digest of the scores,
// the unit and the version. Throws StorageError.
std::string write_scores(const std::filesystem::path& folder, const RunState& run,
                         const std::vector<ResultRow>& rows, const std::vector<std::string>& remarks);
// Removes an earlier run's conclusions if the current run ended before its first score.
void remove_scores(const std::filesystem::path& folder, const RunState& run);

// All conclusion files of the package, beginning with the one that is written last.
const std::vector<std::string>& files_of_conclusions();

}  // namespace salbench
