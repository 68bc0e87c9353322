// SPDX-License-Identifier: GPL-3.0-or-later
// This folder: a build engine, independent of 3D shapes. Rules, units, a seed and a store come in; missing
// results are computed and stored, and decisions, values and records go out. Reading order: level.h (units of
// work), rule.h and binding.h (how an output is computed), plan.h (which jobs to run), resolver.h (one job),
// run.h and graph.cpp (all jobs), maintain.h. It includes cache/, TBB and general headers of io/ and
// stages/core; a test enforces that.
//
// This file: executes a plan, stratum by stratum, each family from its files to its last result, beside other
// processes that work on the same cache.
//
// A rule that gathers a whole level needs values of all units, more than fit in memory: it ends a stratum,
// and its readers belong to later ones. Values pass between strata through the cache.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "pipeline/engine/resolver.h"
#include "stages/core/progress.h"

namespace salbench {

// Stratum of each rule: [rule]. Inputs of a gathered value that others read lie in its stratum, everything
// else in the last one: a value computed earlier than necessary has to be read back later.
std::vector<std::size_t> strata(const Rules& rules);

struct RunOptions {
  int threads = 1;
  // A foreign stage that fails alike on its first `tries` units is not tried on others. These units run
  // before everything else, so that timing has no influence. 0: every unit is tried.
  std::size_t tries = 0;
};

// True if there are jobs to run whose results will be stored.
bool has_work(const Resolver& resolver);

// Returns early once `stop` is set. A unit's failure is recorded and stops nothing else. Jobs claimed by
// other processes come last; most are in the cache by then, the others are awaited. Throws StorageError.
void run_jobs(Resolver& resolver, const RunOptions& options, Progress& progress,
              const std::atomic<bool>& stop);

}  // namespace salbench
