// SPDX-License-Identifier: GPL-3.0-or-later
// Which items a data set has. Layouts of ours are listed by io/shapes/dataset.h, every other one and a user's
// description by the front, without reading a shape.
#pragma once

#include <filesystem>
#include <string>

#include "pipeline/inputs/front.h"

namespace salbench {

// The first layout that fits, of those that "automatic" tries. Throws InputError if there is none.
std::string automatic_layout(const std::filesystem::path& root);

// `layout`: the name of one, a file *.yaml, or "automatic" for the first that fits of gs, schelling,
// princeton and folder. Throws InputError for what is wrong with folder, layout or description, with the
// layouts that would fit.
Dataset find_dataset(const std::filesystem::path& root, const std::string& layout, const Front& front = {});

}  // namespace salbench
