// SPDX-License-Identifier: GPL-3.0-or-later
// Subcommand `gc`: removes from a cache what no run of some configurations needs.
#pragma once

#include <cstddef>

#include "cache/collect.h"
#include "pipeline/plan/plan.h"

namespace salbench {

// Whether the key of a job is not known yet: what it reads is still to be computed, or cannot be read.
bool key_is_unknown(const Job& job);

// Adds what a run of this plan reads or may come to read. Where a job's key is not known yet every artefact
// of its row and item is kept: one of them may turn out to be the result. Returns how many jobs are of that
// kind.
std::size_t add_needed(const Context& context, const Plan& plan, KeepSet& needed);

}  // namespace salbench
