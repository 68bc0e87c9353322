// SPDX-License-Identifier: GPL-3.0-or-later
// Subcommand `verify`: reads every artefact of a cache, and computes a sample of them again.
#pragma once

#include <atomic>
#include <cstddef>
#include <vector>

#include "cache/folder_store.h"
#include "cache/verify.h"
#include "pipeline/plan/plan.h"

namespace salbench {

// Computes `sample` cached jobs again, seeded by the configuration's seed, and compares. Stores nothing; a
// job whose input cannot be read is a fault too. Ends early once `stop` is set.
struct Recomputation {
  std::size_t jobs = 0;  // compared
  std::vector<Fault> faults;
};
Recomputation recompute_sample(const Context& context, const Plan& plan, FolderStore& store,
                               std::size_t sample, const std::atomic<bool>& stop);

}  // namespace salbench
