// SPDX-License-Identifier: GPL-3.0-or-later
// This folder: a build engine, and nothing of 3D. Rules, units, a seed and a store come in; every
// result that is missing is computed and stored, and decisions, values and records go out. To be read in
// this order: level.h (what there is to work on), rule.h and binding.h (how one output is made), plan.h (what
// there is to do), resolver.h (one job), run.h and graph.cpp (all of them), maintain.h. It includes cache/,
// TBB and general headers of io/ and stages/core; a test holds that.
//
// This file: carries a plan out, stratum after stratum, each family from its files to its last result,
// beside other processes that work on the same cache.
//
// A rule that gathers a whole level needs values of all units, more than fit in memory: it ends a stratum,
// and what reads it belongs to a later one. Values cross from one stratum to the next through the cache.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "pipeline/engine/resolver.h"
#include "stages/core/progress.h"

namespace salbench {

// Stratum of each rule: [rule]. What gathered values that others read are made of lies in theirs, everything
// else in the last one: a value that is computed earlier than it has to be is read back later.
std::vector<std::size_t> strata(const Rules& rules);

struct RunOptions {
  int threads = 1;
  // A foreign stage without any result that fails alike on so many units, the first ones, is
  // not tried on others. They come before all else, so that no timing has a say. 0: it is tried on all.
  std::size_t tries = 0;
};

// True if there are jobs to do, whose results will be stored.
bool has_work(const Resolver& resolver);

// Returns early once `stop` is set. A unit's failure is recorded and stops nothing else. Jobs that other
// processes have claimed are left to the end, and waited for; by then most of them are found in the cache.
// Throws StorageError.
void run_jobs(Resolver& resolver, const RunOptions& options, Progress& progress,
              const std::atomic<bool>& stop);

}  // namespace salbench
