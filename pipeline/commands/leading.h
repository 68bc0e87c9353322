// SPDX-License-Identifier: GPL-3.0-or-later
// What a command that makes conclusions ends with: who leads, and how sure that is.
#pragma once

#include "pipeline/commands/report.h"
#include "pipeline/results/leaders.h"

namespace salbench {

// Member `leaders` of the document (docs/json.md): one per data set and split.
Json json_of(const std::vector<LevelLeaders>& leaders);

}  // namespace salbench
