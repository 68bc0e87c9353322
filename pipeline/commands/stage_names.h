// SPDX-License-Identifier: GPL-3.0-or-later
// Stages that an option names.
#pragma once

#include <string>
#include <vector>

#include "pipeline/results/export_file.h"

namespace salbench {

// The stages that a list names, separated by commas: "map" stands for "map.LS" and all its like, and an empty
// list for all that are known. Throws ConfigError for a word that names none.
StageNames selected_stages(const std::string& list, const std::vector<std::string>& known);

}  // namespace salbench
