// SPDX-License-Identifier: GPL-3.0-or-later
// Scores go out to the files of a folder; conclusions from them are drawn by the Python package, and come
// back.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/commands/report.h"
#include "pipeline/results/results.h"

namespace salbench {

// Every file of conclusions that the package may have written to a folder of results; first the one that is
// written last.
const std::vector<std::string>& files_of_conclusions();

// Writes the tables of a run, after conclusions from other scores are removed. Returns what names these
// scores: a digest of them, of the unit and of the version. Throws StorageError.
std::string write_scores(const std::filesystem::path& folder, const RunState& run,
                         const std::vector<ResultRow>& rows, const std::vector<std::string>& remarks);

// Every file that a run and conclusions from it may have in a folder, but for its record.
std::vector<std::string> files_of_scores();
// Those of an earlier run, where the present one was ended before its first score.
void remove_scores(const std::filesystem::path& folder);

struct Concluded {
  std::string text = {};  // what a terminal shows of them
  Json scores = Json::array(), leaders = Json::array();
  std::string missing = {};  // why there are none: there is no package
  std::string failure = {};  // why they could not be drawn

  explicit operator bool() const { return missing.empty() && failure.empty(); }
};

// The conclusions from the scores of this digest in the folder: those that are there, else drawn now. Throws
// Interrupted and StorageError.
Concluded conclude_results(const std::filesystem::path& folder, const std::string& digest);

// Warns of conclusions that are missing; true if they could not be drawn, which was said then.
bool report_trouble(const Concluded& concluded, const std::filesystem::path& folder);

}  // namespace salbench
