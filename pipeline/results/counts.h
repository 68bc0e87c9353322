// SPDX-License-Identifier: GPL-3.0-or-later
// Counts of a plan: jobs per stage over all levels, before or after a run; and the maps of each model,
// computed or read from the cache, with the time range in which the latter were stored.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "cache/folder_store.h"
#include "pipeline/engine/resolver.h"

namespace salbench {

// Rules of each stage, in their order: [stage].
std::vector<std::vector<std::size_t>> rules_by_stage(const Rules& rules);

struct StageCount {
  std::string stage;
  std::int32_t version = 0;
  std::size_t cached = 0, compute = 0, wait = 0, not_applicable = 0, failed = 0;
  std::vector<std::pair<std::string, std::size_t>> reasons = {};  // most frequent first
};

std::string state_of(const Decision& decision);  // "cached", "to compute", "waiting" ...
// Why a job is not simply a cache hit, worded alike for all items; empty for a hit.
std::string why_of(const Project& project, const Plan& plan, const Job& job);

enum class Counted { open, computed };  // jobs whose reasons are counted: before a run, after it
std::vector<StageCount> count_by_stage(const Project& project, const Plan& plan, Counted counted);

struct MapCount {
  using Time = std::chrono::system_clock::time_point;

  std::string model;
  std::size_t computed = 0, read = 0;
  Time first = Time::max(), last = Time::min();  // time of storage of the first and the last map read
};

// Models in the order of the configuration; all kinds of chosen shapes.
std::vector<MapCount> count_maps(const Resolver& resolver, const FolderStore& store);

}  // namespace salbench
