// SPDX-License-Identifier: GPL-3.0-or-later
// Subcommand `explain`: why each artefact of an item is a hit or not.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/engine/plan.h"

namespace salbench {

struct ExplainOptions {
  std::string item;   // "52", "52_3"
  std::string stage;  // empty: all
};

struct Explanation {
  std::string stage;
  std::string state;           // "cached", "to compute", "waiting", "damaged" ...
  std::string why;             // one line; empty for a hit
  std::filesystem::path file;  // the artefact, or the nearest; empty if there is none
};

// In the order of the rules. Throws ConfigError for an item or a stage that does not exist.
std::vector<Explanation> explain(const Project& project, const Index& index,
                                 const std::filesystem::path& cache, const ExplainOptions& options);

}  // namespace salbench
