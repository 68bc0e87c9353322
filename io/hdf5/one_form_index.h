// SPDX-License-Identifier: GPL-3.0-or-later
// index.csv of a data set in the HDF5 form (io/hdf5/one_form.h): one row per scored unit, so that items,
// classes and splits are known before any file is read. Columns: docs/hdf5_form.md.
#pragma once

#include <filesystem>
#include <string>

#include "io/shapes/dataset.h"

namespace salbench {

inline constexpr const char* kIndexFile = "index.csv";

std::string file_of_shape(const std::string& shape);  // "items/cow.h5"

// Data set of a folder with an index. Throws InputError that names file and line: missing column, invalid
// file name, item listed twice.
Dataset indexed_dataset(const std::filesystem::path& root);

}  // namespace salbench
