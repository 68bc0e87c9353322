// SPDX-License-Identifier: GPL-3.0-or-later
// The artefacts of a cache folder, for tests that look at their files.
#pragma once

#include <filesystem>
#include <iterator>
#include <ranges>
#include <vector>

#include "cache/layout.h"

namespace salbench {

inline std::vector<ArtefactFile> artefacts_of(const std::filesystem::path& cache) {
  std::vector<ArtefactFile> all;
  for (const ShardFolder& shard : list_cache(cache).shards)
    std::ranges::move(list_shard(cache, shard), std::back_inserter(all));
  return all;
}

}  // namespace salbench
