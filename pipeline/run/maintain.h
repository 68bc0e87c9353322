// SPDX-License-Identifier: GPL-3.0-or-later
// A cache and the configurations that it is kept for.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "cache/collect.h"
#include "pipeline/run/request.h"
#include "stages/core/progress.h"

namespace salbench {

struct CollectOptions {
  std::vector<Request> kept;    // whose artefacts stay, or which name the cache
  std::filesystem::path cache;  // empty: theirs
  std::string stages;           // to be removed, and nothing else: "map.LS,fpfh"; empty: what no run needs
  bool dry_run = false;
};
struct CollectedCache {
  std::filesystem::path cache;
  Collected collected;
  std::size_t waiting = 0;  // jobs whose keys are not known yet: all of their stages and items was kept
};
// Throws ConfigError where the configurations have several caches, or a stage is none.
CollectedCache collect(const CollectOptions& options, const Front& front, Progress& progress);

}  // namespace salbench
