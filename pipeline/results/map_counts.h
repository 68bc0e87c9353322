// SPDX-License-Identifier: GPL-3.0-or-later
// Maps per model that a run computed or read from the cache, and from when those are.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "cache/folder_store.h"
#include "io/table.h"
#include "pipeline/engine/resolver.h"

namespace salbench {

struct MapCount {
  using Time = std::chrono::system_clock::time_point;

  std::string model;
  std::size_t computed = 0, read = 0;
  Time first = Time::max(), last = Time::min();  // when the first and the last one read were stored
};

// Models in the order of the configuration; shapes of all kinds that were chosen.
std::vector<MapCount> count_maps(const Resolver& resolver, const FolderStore& store);

// For the console: model, computed, read, and from when in local time.
Table map_table(const std::vector<MapCount>& counts);

}  // namespace salbench
