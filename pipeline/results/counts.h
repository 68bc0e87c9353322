// SPDX-License-Identifier: GPL-3.0-or-later
// Counts of a plan: jobs per stage, all levels together, before a run or after it; and the maps of each
// model, computed by a run or read from the cache, and from when those are.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "cache/folder_store.h"
#include "pipeline/engine/resolver.h"

namespace salbench {

// Of each stage its rules, in their order: [stage].
std::vector<std::vector<std::size_t>> rules_by_stage(const Rules& rules);

struct StageCount {
  std::string stage;
  std::int32_t version = 0;
  std::size_t cached = 0, compute = 0, wait = 0, not_applicable = 0, failed = 0;
  std::vector<std::pair<std::string, std::size_t>> reasons = {};  // most frequent first
};

std::string state_of(const Decision& decision);  // "cached", "to compute", "waiting" ...
// Why it is not simply a hit, in words that are the same for every item; empty if it is one.
std::string why_of(const Project& project, const Plan& plan, const Job& job);

enum class Counted { open, computed };  // jobs whose reasons are counted: before a run, after it
std::vector<StageCount> count_by_stage(const Project& project, const Plan& plan, Counted counted);

struct MapCount {
  using Time = std::chrono::system_clock::time_point;

  std::string model;
  std::size_t computed = 0, read = 0;
  Time first = Time::max(), last = Time::min();  // when the first and the last one read were stored
};

// Models in the order of the configuration; shapes of all kinds that were chosen.
std::vector<MapCount> count_maps(const Resolver& resolver, const FolderStore& store);

}  // namespace salbench
