// SPDX-License-Identifier: GPL-3.0-or-later
// run.yaml: what ran, over which data, with which configuration, and what each node of the graph did. What
// depends on the machine and its load stands here and in costs.csv, and in no other table.
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
  bool interrupted = false;    // the tables hold what was finished
  std::string scores = {};     // what names them; empty: none were written
  std::string selection = {};  // lines that say which items were taken
};

// run.yaml and costs.csv (costs.h); of a run over a share its record alone, shard_2_of_4.yaml.
// Throws StorageError.
void write_record(const std::filesystem::path& folder, const RunRecord& record);

// run.yaml of a run that has not ended. It has the configuration, so that the run can be started again by it.
// selection: as in RunRecord.
std::string unfinished_record(const Config& config, const std::string& selection);

// Says whether the results in a folder are those of a finished run: "partial, 12 of 25 shapes have all
// scores". Empty if there is no record.
std::string state_of_results(const std::filesystem::path& folder);

// What results and times depend on: "oneTBB 2021.8.0", of the libraries that are loaded; "(built with
// 2021.7)" behind it if the headers were others.
std::vector<std::string> libraries();

}  // namespace salbench
