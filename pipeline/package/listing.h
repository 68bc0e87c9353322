// SPDX-License-Identifier: GPL-3.0-or-later
// Which items a data set has. Layouts of the program's own are listed by io/shapes/dataset.h; of every other
// layout, and of a user's description, the Python package tells what there is, without reading a shape.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/shapes/dataset.h"

namespace salbench {

// The first layout that fits, of those that "automatic" tries. Throws InputError if there is none.
std::string automatic_layout(const std::filesystem::path& root);

// For an error that says where shapes were looked for: "; the layout that fits: sal3d", of those by which the
// folder has some. Empty for another error, and where none does. No shape is read.
std::string layouts_that_fit(const std::filesystem::path& root, std::string_view error);

// `layout`: the name of one, a file *.yaml, or "automatic" for the first that fits of gs, schelling,
// princeton and folder. Throws InputError for what is wrong with folder, layout or description; ConfigError,
// which names the package, where it is needed and missing.
Dataset find_dataset(const std::filesystem::path& root, const std::string& layout);

// Text in the JSON that the package reads and writes (python/salbench/_wire.py): strings are those
// of the system, UTF-8 or not, with a character for each byte.
std::string json_text(const std::string& bytes);
std::vector<std::string> names_in_json(std::string_view list);

// The package's list as it prints it. Anything unexpected in it is a defect of ours: std::logic_error.
Dataset listed_dataset(std::string_view document);

}  // namespace salbench
