// SPDX-License-Identifier: GPL-3.0-or-later
// index.csv of a data set in the one form (io/hdf5/one_form.h): a row per unit that is scored, so that items,
// classes and splits are known before any file is read. docs/hdf5_form.md has its columns.
#pragma once

#include <filesystem>
#include <string>

#include "io/shapes/dataset.h"

namespace salbench {

inline constexpr const char* kIndexFile = "index.csv";

std::string file_of_shape(const std::string& shape);  // "items/cow.h5"

// The data set of a folder with an index. Throws InputError that names file and line: a column that is
// missing, a name that is no file's, an item listed twice.
Dataset indexed_dataset(const std::filesystem::path& root);

}  // namespace salbench
