// SPDX-License-Identifier: GPL-3.0-or-later
// The folder of a run's results. Two runs that write to it at the same time leave whole files of either.
// Conclusions from the scores are drawn by the Python package, which writes conclusions.json last: where it
// is, all tables of conclusions are, and are of the scores that it names.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/results/results.h"

namespace salbench {

// Makes the folder, and tells in it that a run is under way. record: what the run can be repeated by. Throws
// StorageError, and ConfigError where files of a run's names are of no run.
void begin_results(const std::filesystem::path& folder, const std::string& record);

// Writes the tables of a run, after conclusions from other scores are removed. Returns what names these
// scores: a digest of them, of the unit and of the version. Throws StorageError.
std::string write_scores(const std::filesystem::path& folder, const RunState& run,
                         const std::vector<ResultRow>& rows, const std::vector<std::string>& remarks);
// Removes the conclusions of an earlier run, where the present one was ended before its first score.
void remove_scores(const std::filesystem::path& folder);

// Every file of conclusions that the package may have written; first the one that is written last.
const std::vector<std::string>& files_of_conclusions();

}  // namespace salbench
