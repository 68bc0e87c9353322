// SPDX-License-Identifier: GPL-3.0-or-later
// Lists the items of a data set: the layouts schelling, folder and hdf5 by io/shapes/dataset.h, all others by
// the front. No shape is read.
#pragma once

#include <filesystem>
#include <string>

#include "pipeline/inputs/front.h"

namespace salbench {

// First matching layout among those that "automatic" tries. Throws InputError if none matches.
std::string automatic_layout(const std::filesystem::path& root);

// `layout`: a name, a file *.py, or "automatic" for the first match among gs, schelling, princeton and
// folder. Throws InputError for a wrong folder or layout, with the layouts that would fit.
Dataset find_dataset(const std::filesystem::path& root, const std::string& layout, const Front& front = {});

}  // namespace salbench
