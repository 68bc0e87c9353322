// SPDX-License-Identifier: GPL-3.0-or-later
// What maps cost, as the cache has it from when they were computed: a run that finds them there says the
// same.
#pragma once

#include "cache/folder_store.h"
#include "io/table.h"
#include "pipeline/results/results.h"

namespace salbench {

// dataset, item, view, model, seconds, processor_seconds, input_seconds: a row per shape and map that was
// computed. input_seconds is the sum over all that the map was made of, each once, whoever else reads it.
// Empty where the cache does not say.
Table costs_table(const RunState& run, const FolderStore& store);

}  // namespace salbench
