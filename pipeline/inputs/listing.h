// SPDX-License-Identifier: GPL-3.0-or-later
// Lists the items of a data set: io/shapes/dataset.h those of the layouts schelling, folder and hdf5, the
// front those of every other data set. No shape is read.
#pragma once

#include <filesystem>
#include <string>

#include "pipeline/inputs/front.h"

namespace salbench {

// The first layout that fits, of those that "automatic" tries. Throws InputError if there is none.
std::string automatic_layout(const std::filesystem::path& root);

// `layout`: the name of one, a file *.py, or "automatic" for the first that fits of gs, schelling,
// princeton and folder. Throws InputError for what is wrong with folder or layout, with the
// layouts that would fit.
Dataset find_dataset(const std::filesystem::path& root, const std::string& layout, const Front& front = {});

}  // namespace salbench
