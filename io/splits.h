// SPDX-License-Identifier: GPL-3.0-or-later
// The splits of a data set (train, val, test), as a description says where they are written.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "io/file_pattern.h"

namespace salbench {

struct NamedSplit {
  std::string name;
  std::vector<std::string> items;
  std::string where;  // of the description, "own.yaml:7"
};

// One of three: a table, a list whose first lines are one split, or names in the description itself.
struct DataSplits {
  std::string table;                                   // CSV file, below the folder of the data set
  std::string item = "item", split = "split";          // its columns
  std::string list;                                    // file with the path of an item's file in each line
  std::vector<std::pair<std::string, double>> shares;  // of its lines, in their order; they sum to 1
  std::vector<NamedSplit> named;
  std::string where;  // of the description

  bool empty() const { return table.empty() && list.empty() && named.empty(); }
};

// One item of a split, and where that is written.
struct SplitEntry {
  std::string item, split, where;
};

struct FoundSplits {
  std::map<std::string, std::string, std::less<>> of_item;   // those that are in one split
  std::map<std::string, std::string, std::less<>> problems;  // item -> why its split is not known
  std::vector<SplitEntry> unknown = {};                      // names that are no items
  std::string missing = {};                                  // the file that is not there: one line
};

// Message about names that are no items: file and line of the first one, and what to do.
std::string text_of_unknown(const std::vector<SplitEntry>& unknown);

// Reads the file of the splits, if there is one. A line of a list names an item by its last name, with or
// without extension, up to the first comma, semicolon or tab. Throws InputError for a table without these
// columns.
FoundSplits read_splits(const std::filesystem::path& root, const DataSplits& splits, const IsItem& is_item);

}  // namespace salbench
