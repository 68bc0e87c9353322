// SPDX-License-Identifier: GPL-3.0-or-later
// Maintains a cache: what of it is needed, and whether it would come out again.
#pragma once

#include <atomic>
#include <cstddef>

#include "cache/collect.h"
#include "cache/folder_store.h"
#include "cache/verify.h"
#include "pipeline/engine/plan.h"

namespace salbench {

// Adds all artefacts that a run would read or write. Of jobs that wait for an input the keys are not known:
// everything of their stages and units is kept. Returns how many there are.
std::size_t add_needed(const Project& project, const Plan& plan, KeepSet& needed);

struct Recomputation {
  std::size_t jobs = 0;
  std::vector<Fault> faults;  // in the order in which they were found
};

// Computes a random sample of the cached jobs again and compares the contents. Throws StorageError.
Recomputation recompute_sample(const Project& project, const Plan& plan, FolderStore& store,
                               std::size_t sample, const std::atomic<bool>& stop);

}  // namespace salbench
