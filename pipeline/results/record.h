// SPDX-License-Identifier: GPL-3.0-or-later
// run.yaml: program, data, configuration, and statistics of each node of the graph. Machine and load affect
// only this file and costs.csv.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cache/folder_store.h"
#include "io/table.h"
#include "pipeline/results/counts.h"
#include "pipeline/results/results.h"

namespace salbench {

struct RunRecord {
  RunState run;
  FolderStore& store;
  int threads = 1;
  double seconds = 0;
  bool interrupted = false;    // the tables hold the finished part
  std::string scores = {};     // digest of the score tables; empty: none written
  std::string selection = {};  // lines with the selected items
};

// Writes run.yaml and costs.csv (costs.h); for a share only its record, such as shard_2_of_4.yaml. Throws
// StorageError.
void write_record(const std::filesystem::path& folder, const RunRecord& record);

// run.yaml of an unfinished run, with the configuration to start it again. selection: as in RunRecord.
std::string unfinished_record(const Config& config, const std::string& selection);

// State of the results in a folder: "partial, 12 of 25 shapes have all scores" if the run did not finish.
// Empty without a record.
std::string state_of_results(const std::filesystem::path& folder);

// Libraries that affect results and times, as loaded: "oneTBB 2021.8.0"; followed by "(built with 2021.7)" if
// the headers differ.
std::vector<std::string> libraries();

}  // namespace salbench
