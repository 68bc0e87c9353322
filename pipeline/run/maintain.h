// SPDX-License-Identifier: GPL-3.0-or-later
// Collects unneeded artefacts from a cache.
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
  std::vector<Request> kept;    // configurations whose artefacts stay, or which name the cache
  std::filesystem::path cache;  // empty: the one of `kept`
  std::string stages;           // remove only these: "map.LS,fpfh"; empty: everything that no run needs
  bool dry_run = false;
};
struct CollectedCache {
  std::filesystem::path cache;
  Collected collected;
  std::size_t waiting = 0;  // jobs without known keys: everything of their stages and items was kept
};
// Throws ConfigError if the configurations have several caches, or for an unknown stage.
CollectedCache collect(const CollectOptions& options, const Front& front, Progress& progress);

}  // namespace salbench
