// SPDX-License-Identifier: GPL-3.0-or-later
// index.csv of a data set in the one form (io/hdf5/one_form.h): a row per unit that is scored, so that items,
// classes and splits are known before any file is read. docs/hdf5_form.md has its columns.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/shapes/dataset.h"

namespace salbench {

inline constexpr const char* kIndexFile = "index.csv";

struct IndexRow {
  Item item;
  std::string source = {};  // data set that it was imported from
};

std::string file_of_shape(const std::string& shape);  // "items/cow.h5"

// remark: on the ground truth; empty if there is none.
std::string index_text(const std::vector<IndexRow>& rows, const std::string& remark = {});

// Throws InputError that names file and line: a column that is missing, a name that is no file's, an item
// listed twice.
std::vector<IndexRow> read_index(const std::filesystem::path& file);

// The data set of a folder with an index. Throws InputError.
Dataset indexed_dataset(const std::filesystem::path& root);

}  // namespace salbench
