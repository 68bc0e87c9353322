// SPDX-License-Identifier: GPL-3.0-or-later
// Costs of maps, as stored in the cache when they were computed: a run that finds them there reports the
// same.
#pragma once

#include "cache/folder_store.h"
#include "io/table.h"
#include "pipeline/results/results.h"

namespace salbench {

// dataset, item, view, model, seconds, processor_seconds, input_seconds: one row per shape and computed map.
// input_seconds is the sum over everything the map was computed from, each counted once, even if others read
// it. Empty where the cache has no figure.
Table costs_table(const RunState& run, const FolderStore& store);

}  // namespace salbench
