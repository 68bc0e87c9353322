// SPDX-License-Identifier: GPL-3.0-or-later
// Inspection of a data set: every file of every item is read, and nothing is computed from it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "io/dataset.h"

namespace salbench {

struct ItemFacts {
  std::string name, shape, view, split, category;
  bool is_cloud = false;
  std::size_t points = 0, faces = 0;
  double diagonal = 0;                      // of the bounding box, unit of the file times the scale
  std::size_t participants = 0, picks = 0;  // who picked points or has a map; all picks of them
  std::size_t seen = 0;                     // points with a value; all of them where there are picks alone
  double low = std::numeric_limits<double>::quiet_NaN(), high = low;  // of these values; NaN: there are none
  bool has_truth = false;
  bool of_camera = false;  // what a camera does not see is hidden
  std::string remark;      // on the shape
  std::string problem;     // why the item fails: one line; empty if it does not
};

struct DataInspection {
  std::string layout;
  std::string positives;  // as the description has it: picks, or a rule
  double scale = 1;       // of the files' coordinates
  std::vector<ItemFacts> items;
  std::vector<std::string> notes;   // on the data set: one line each
  std::vector<std::string> unused;  // files below the folder that belong to no item, in natural order

  std::size_t n_shapes() const;
  std::vector<std::string> problems() const;  // of items, then the notes
};

// Throws as find_dataset does.
DataInspection inspect_data(const std::filesystem::path& root, std::span<const Layout> layouts);

}  // namespace salbench
