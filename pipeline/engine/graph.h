// SPDX-License-Identifier: GPL-3.0-or-later
// The flow graph: a node per rule, which settles jobs whose inputs are all settled, and so lets others
// begin: of the same unit, of its parts, and of what gathers it.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

#include "pipeline/engine/plan.h"

namespace salbench {

// Bodies of the nodes; they know no TBB. Called from several threads at once, for different jobs.
struct GraphBodies {
  // True if a job is to be settled in this stream. Asked once for each, before the first is.
  std::function<bool(const Job&)> is_open = {};
  // A family has a token and may begin. False: it cannot now, and its jobs stay open.
  std::function<bool(std::size_t family)> enter_family = {};
  // Everything that the job reads is settled. False: it cannot be done now (jobs of the root only).
  std::function<bool(const Job&)> settle_job = {};
  // The last job of a family is settled, or the stream has ended early; once per family that entered.
  std::function<void(std::size_t family)> leave_family = {};
};

struct GraphLimits {
  int threads = 1;
  int families = 2;  // entered and not left: what bounds the memory
};

// Returns when every job that could be settled is; once `stop` is set, when the jobs at work are. If a body
// throws, the rest is abandoned and the first exception is thrown again here.
void stream_jobs(const Project& project, const GraphLimits& limits, const std::atomic<bool>& stop,
                 const GraphBodies& bodies);

}  // namespace salbench
