// SPDX-License-Identifier: GPL-3.0-or-later
// The flow graph: one node per rule. A node runs jobs whose inputs have all finished; each finished job may
// release jobs of the same unit, of its parts, and of rules that gather it.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

#include "pipeline/engine/plan.h"

namespace salbench {

// Callbacks of the nodes, independent of TBB. Called concurrently for different jobs.
struct GraphBodies {
  // True if a job takes part in this stream. Asked once per job, before any job starts.
  std::function<bool(const Job&)> is_open = {};
  // Called when a family obtains a token. False: it cannot begin now, and its jobs stay open.
  std::function<bool(std::size_t family)> enter_family = {};
  // Runs a job whose inputs have all finished. False: it cannot be done now (jobs of the root only).
  std::function<bool(const Job&)> settle_job = {};
  // Called once per family that entered, when its last job has finished or the stream ended early.
  std::function<void(std::size_t family)> leave_family = {};
};

struct GraphLimits {
  int threads = 1;
  int families = 2;  // families in flight at a time, which bounds memory
};

// Returns when every runnable job has finished or, once `stop` is set, when the running jobs have. If a
// callback throws, remaining jobs are abandoned and the first exception is rethrown.
void stream_jobs(const Project& project, const GraphLimits& limits, const std::atomic<bool>& stop,
                 const GraphBodies& bodies);

}  // namespace salbench
