// SPDX-License-Identifier: GPL-3.0-or-later
// Cache maintenance: which artefacts are needed, and whether recomputation reproduces them.
#pragma once

#include <atomic>
#include <cstddef>

#include "cache/collect.h"
#include "cache/folder_store.h"
#include "cache/verify.h"
#include "pipeline/engine/plan.h"

namespace salbench {

// Adds all artefacts that a run would read or write. Keys of waiting jobs are unknown, so everything of their
// stages and units is kept. Returns the number of such jobs.
std::size_t add_needed(const Project& project, const Plan& plan, KeepSet& needed);

struct Recomputation {
  std::size_t jobs = 0;
  std::vector<Fault> faults;  // in the order of discovery
};

// Recomputes a random sample of the cached jobs and compares contents. Throws StorageError.
Recomputation recompute_sample(const Project& project, const Plan& plan, FolderStore& store,
                               std::size_t sample, const std::atomic<bool>& stop);

}  // namespace salbench
