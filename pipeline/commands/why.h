// SPDX-License-Identifier: GPL-3.0-or-later
// Words for causes: why a job is not simply a hit.
#pragma once

#include <string>
#include <string_view>

#include "pipeline/engine/causes.h"
#include "pipeline/results/stage_counts.h"

namespace salbench {

std::string_view words_of(Reason reason);

// One line for one job: "fpfh.radius 0.02 -> 0.03", "mesh file 52.off changed", with the first cause of what
// it waits for and of inputs that changed.
std::string why_line(Causes& causes, const Job& job, const Cause& cause);

// The same words for every job with the same cause, to be counted; `causes` must outlive it.
Why why_open(Causes& causes);
Why why_computed(Causes& causes);  // after a run: nothing for jobs that it found or left

}  // namespace salbench
